// A condition that must hold for every input of a fuzz target. Where it does not, the target ends,
// and libFuzzer keeps the input.
#pragma once

#include <cstdlib>

namespace thunderhead::fuzz {

inline void Must(bool condition) {
  if (!condition) std::abort();
}

}  // namespace thunderhead::fuzz
