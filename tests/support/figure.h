// Prints figures: measured values that depend on the machine's speed. No test fails because of a
// figure. `./dev bench waits` collects the figures that test suites named ...Benchmark print.
#pragma once

#include <cstdio>

namespace thunderhead::testing {

// Prints one measured value, for example Figure("acknowledged frame, median", 12.5, "ms").
inline void Figure(const char* name, double value, const char* unit) {
  std::printf("figure: %s: %.4g %s\n", name, value, unit);
  std::fflush(stdout);
}

}  // namespace thunderhead::testing
