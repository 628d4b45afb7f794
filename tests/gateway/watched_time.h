// A manual time that knows how often it was looked at.
#pragma once

#include <atomic>

#include "tests/support/manual_time.h"
#include "tests/support/wait_for.h"

namespace thunderhead::gateway::test {

class WatchedTime : public testing::ManualTime {
 public:
  Clock::time_point LookAgainAt(Clock::time_point deadline) const override {
    ++looks_;
    return ManualTime::LookAgainAt(deadline);
  }

  // Waits until those that wait by this time have looked at it often enough that each has acted on
  // the present time. Needs one that waits, and suits a test with few of them. The gateway handles
  // its sockets and its timers on one thread, so what reached its sockets before is handled too.
  bool AwaitLooks() const {
    constexpr long kLooks = 20;
    const long wanted = looks_ + kLooks;
    return testing::WaitFor([&] { return looks_ >= wanted; });
  }

 private:
  mutable std::atomic<long> looks_{0};
};

}  // namespace thunderhead::gateway::test
