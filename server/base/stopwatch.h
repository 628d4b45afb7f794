// A stopwatch: measures elapsed time in milliseconds on the steady clock.
#pragma once

#include <chrono>

namespace thunderhead::base {

class Stopwatch {
 public:
  // Returns the milliseconds since construction or the last Restart.
  double ElapsedMs() const {
    return std::chrono::duration<double, std::milli>(Clock::now() - start_).count();
  }

  // Returns ElapsedMs() and starts again from zero.
  double Restart() {
    const double elapsed_ms = ElapsedMs();
    start_ = Clock::now();
    return elapsed_ms;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

}  // namespace thunderhead::base
