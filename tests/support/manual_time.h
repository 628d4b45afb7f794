// A time source that moves only when a test moves it.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>

#include "base/time_source.h"

namespace thunderhead::testing {

// Threads that wait by it notice a new time within a few milliseconds. Safe from any thread.
class ManualTime : public base::TimeSource {
 public:
  Clock::time_point Now() const override { return Clock::time_point(Clock::duration(now_.load())); }

  Clock::time_point LookAgainAt(Clock::time_point deadline) const override {
    return std::min(deadline, Clock::now() + std::chrono::milliseconds(2));
  }

  // Moves the time forward.
  void Advance(Clock::duration by) { now_ += by.count(); }

 private:
  // It starts at the real time, so that it can be mixed with times that were taken before.
  std::atomic<Clock::rep> now_{Clock::now().time_since_epoch().count()};
};

}  // namespace thunderhead::testing
