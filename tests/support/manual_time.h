// A time source whose time moves only when a test moves it.
#pragma once

#include <atomic>
#include <chrono>

#include "base/time_source.h"

namespace thunderhead::testing {

// A manual clock. Threads that wait for a deadline of this clock notice a new time within a few
// milliseconds. Any thread may call its methods.
class ManualTime : public base::TimeSource {
 public:
  Clock::time_point Now() const override { return Clock::time_point(Clock::duration(now_.load())); }

  // Returns the real time at which a waiting thread must check this clock again. A deadline that
  // has passed on the real clock may still be in the future on this clock. The thread must sleep
  // nevertheless, because it would otherwise keep a processor busy.
  Clock::time_point LookAgainAt(Clock::time_point deadline) const override {
    const Clock::time_point real = Clock::now();
    ++looks_;
    return Now() >= deadline ? real : real + std::chrono::milliseconds(2);
  }

  // Moves the time forward.
  void Advance(Clock::duration by) { now_ += by.count(); }

  // Returns how many times threads have found that their deadline has not passed yet. If only one
  // thread waits, an increase of two after Advance() proves that this thread is still waiting.
  int Looks() const { return looks_; }

 private:
  mutable std::atomic<int> looks_{0};
  // The time starts at the real time, so that it can be compared with times that were taken before.
  std::atomic<Clock::rep> now_{Clock::now().time_since_epoch().count()};
};

}  // namespace thunderhead::testing
