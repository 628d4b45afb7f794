// A manual time that counts how often it was read.
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

  // Waits until every waiter of this time has read it often enough to have handled the present
  // time. It needs at least one waiter, and suits tests with few of them. The gateway handles its
  // sockets and its timers on one thread, so input that reached its sockets before is handled too.
  bool AwaitLooks() const {
    constexpr long kLooks = 20;
    const long wanted = looks_ + kLooks;
    return testing::WaitFor([&] { return looks_ >= wanted; });
  }

 private:
  mutable std::atomic<long> looks_{0};
};

}  // namespace thunderhead::gateway::test
