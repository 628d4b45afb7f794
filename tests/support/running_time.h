// A time source that runs like the real time. A test can move it ahead or stop it.
#pragma once

#include <algorithm>
#include <chrono>
#include <mutex>
#include <optional>

#include "base/time_source.h"

namespace thunderhead::testing {

// A clock for tests of whole servers. A server needs a running clock because it limits some actions
// to a number per second. A timeout under test must be so long that it does not expire before the
// test moves the clock. Threads that wait for a deadline of this clock notice a new time within a
// few milliseconds. Any thread may call its methods.
class RunningTime : public base::TimeSource {
 public:
  Clock::time_point Now() const override {
    const std::lock_guard lock(mutex_);
    return stopped_at_.value_or(Clock::now()) + ahead_;
  }

  Clock::time_point LookAgainAt(Clock::time_point deadline) const override {
    const std::lock_guard lock(mutex_);
    const Clock::time_point real = Clock::now();
    // While this clock is stopped, a deadline that has passed on the real clock may still be in the
    // future on this clock.
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

  // Stops the clock. From then on only Advance() moves it.
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
