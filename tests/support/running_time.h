// A time source that runs like the real time, and that a test moves ahead or stops.
#pragma once

#include <algorithm>
#include <chrono>
#include <mutex>
#include <optional>

#include "base/time_source.h"

namespace thunderhead::testing {

// For whole servers, which do some things only as time passes, e.g. tell people at most some times
// a second. Timeouts that a test is about must be so long that they end nothing before the test
// moves the time. Threads that wait by it notice a new time within a few milliseconds. Safe from
// any thread.
class RunningTime : public base::TimeSource {
 public:
  Clock::time_point Now() const override {
    const std::lock_guard lock(mutex_);
    return stopped_at_.value_or(Clock::now()) + ahead_;
  }

  Clock::time_point LookAgainAt(Clock::time_point deadline) const override {
    const std::lock_guard lock(mutex_);
    const Clock::time_point real = Clock::now();
    // While it is stopped, a deadline that has passed on the real clock may still be ahead.
    const Clock::time_point due = deadline - ahead_;
    const bool waits = stopped_at_.has_value() && *stopped_at_ < due;
    const Clock::time_point soon = real + std::chrono::milliseconds(2);
    return waits ? soon : std::min(due, soon);
  }

  // Moves the time forward.
  void Advance(Clock::duration by) {
    const std::lock_guard lock(mutex_);
    ahead_ += by;
  }

  // From now on only Advance moves it.
  void Stop() {
    const std::lock_guard lock(mutex_);
    stopped_at_ = stopped_at_.value_or(Clock::now());
  }

 private:
  mutable std::mutex mutex_;
  Clock::duration ahead_{};
  std::optional<Clock::time_point> stopped_at_;
};

}  // namespace thunderhead::testing
