// An interface to a monotonic clock. Code that compares times, or that waits until a time, reads
// the clock through a TimeSource. A test can then pass a source whose time it sets by hand
// (tests/support/manual_time.h), so that it does not have to sleep.
#pragma once

#include <chrono>
#include <thread>

namespace thunderhead::base {

class TimeSource {
 public:
  using Clock = std::chrono::steady_clock;

  virtual ~TimeSource() = default;

  virtual Clock::time_point Now() const = 0;

  // Returns when a thread that waits until `deadline` must call Now() again. The result is a time
  // of std::chrono::steady_clock, and is never later than `deadline`.
  virtual Clock::time_point LookAgainAt(Clock::time_point deadline) const = 0;
};

// Returns the source that reads std::chrono::steady_clock. It lives as long as the process.
inline const TimeSource& SteadyTime() {
  class Steady : public TimeSource {
   public:
    Clock::time_point Now() const override { return Clock::now(); }
    Clock::time_point LookAgainAt(Clock::time_point deadline) const override { return deadline; }
  };
  // The object is never destroyed, because threads may still read it while static objects are being
  // destroyed.
  static const auto* const steady = new Steady;
  return *steady;
}

// Returns the milliseconds that have passed since `start` by `time`.
inline double MsSince(const TimeSource& time, TimeSource::Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(time.Now() - start).count();
}

// Waits on the condition variable `changed` until `ready()` is true or `deadline` has passed by
// `time`. Returns whether `ready()` is true. `lock` holds the mutex that guards what `ready` reads.
template <typename ConditionVariable, typename Lock, typename Ready>
bool WaitUntil(const TimeSource& time, ConditionVariable& changed, Lock& lock,
               TimeSource::Clock::time_point deadline, Ready ready) {
  while (!ready()) {
    if (time.Now() >= deadline) return false;
    changed.wait_until(lock, time.LookAgainAt(deadline));
  }
  return true;
}

// Blocks the calling thread until `deadline` has passed by `time`.
inline void SleepUntil(const TimeSource& time, TimeSource::Clock::time_point deadline) {
  while (time.Now() < deadline) std::this_thread::sleep_until(time.LookAgainAt(deadline));
}

}  // namespace thunderhead::base
