// A condition that must hold for every input of a fuzz target. If it does not hold, the target
// aborts, and libFuzzer keeps the input.
#pragma once

#include <cstdlib>

namespace thunderhead::fuzz {

inline void Must(bool condition) {
  if (!condition) std::abort();
}

}  // namespace thunderhead::fuzz
