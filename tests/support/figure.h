// Figures that depend on the speed of the machine. A test never fails by one: it prints it, and
// `./dev bench waits` collects what suites named ...Benchmark print.
#pragma once

#include <cstdio>

namespace thunderhead::testing {

// Prints one measured value, e.g. Figure("acknowledged frame, median", 12.5, "ms").
inline void Figure(const char* name, double value, const char* unit) {
  std::printf("figure: %s: %.4g %s\n", name, value, unit);
  std::fflush(stdout);
}

}  // namespace thunderhead::testing
