// What holds whatever the input: a fuzz target ends by it, and the input is kept.
#pragma once

#include <cstdlib>

namespace thunderhead::fuzz {

inline void Must(bool condition) {
  if (!condition) std::abort();
}

}  // namespace thunderhead::fuzz
