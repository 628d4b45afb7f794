// A time source that moves only when a test moves it.
#pragma once

#include <atomic>
#include <chrono>

#include "base/time_source.h"

namespace thunderhead::testing {

// Threads that wait by it notice a new time within a few milliseconds. Safe from any thread.
class ManualTime : public base::TimeSource {
 public:
  Clock::time_point Now() const override { return Clock::time_point(Clock::duration(now_.load())); }

  // A deadline that has passed on the real clock may be ahead by this time: its waiters must sleep
  // all the same, or they would take a processor.
  Clock::time_point LookAgainAt(Clock::time_point deadline) const override {
    const Clock::time_point real = Clock::now();
    ++looks_;
    return Now() >= deadline ? real : real + std::chrono::milliseconds(2);
  }

  // Moves the time forward.
  void Advance(Clock::duration by) { now_ += by.count(); }

  // Returns how often threads have found that it is not time yet. Where one thread waits, two more
  // looks after an Advance tell that it goes on waiting.
  int Looks() const { return looks_; }

 private:
  // It starts at the real time, so that it can be mixed with times that were taken before.
  mutable std::atomic<int> looks_{0};
  std::atomic<Clock::rep> now_{Clock::now().time_since_epoch().count()};
};

}  // namespace thunderhead::testing
