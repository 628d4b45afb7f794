// A time source that moves only when a test moves it.
#pragma once

#include <atomic>
#include <chrono>

#include "base/time_source.h"

namespace thunderhead::testing {

// A manual clock. Threads that wait by it notice a new time within a few milliseconds. Any thread
// may use it.
class ManualTime : public base::TimeSource {
 public:
  Clock::time_point Now() const override { return Clock::time_point(Clock::duration(now_.load())); }

  // A deadline that has passed on the real clock may still be in the future on this clock. Its
  // waiters must sleep nevertheless, because they would otherwise keep a processor busy.
  Clock::time_point LookAgainAt(Clock::time_point deadline) const override {
    const Clock::time_point real = Clock::now();
    ++looks_;
    return Now() >= deadline ? real : real + std::chrono::milliseconds(2);
  }

  // Moves the time forward.
  void Advance(Clock::duration by) { now_ += by.count(); }

  // Returns how often threads have found that their deadline has not passed. If one thread waits,
  // an increase of two after Advance() proves that the thread is still waiting.
  int Looks() const { return looks_; }

 private:
  // The time starts at the real time, so that it can be compared with times that were taken before.
  mutable std::atomic<int> looks_{0};
  std::atomic<Clock::rep> now_{Clock::now().time_since_epoch().count()};
};

}  // namespace thunderhead::testing
