#include "base/executor.h"

#include <algorithm>
#include <atomic>
#include <future>
#include <mutex>
#include <new>
#include <string>
#include <thread>
#include <vector>

#include "base/error_details.h"
#include "gtest/gtest.h"
#include "tests/support/manual_time.h"
#include "tests/support/wait_for.h"

namespace thunderhead::base {
namespace {

using std::chrono::milliseconds;
using testing::ManualTime;
using testing::WaitFor;

// Tasks that hang until the test releases them, and an object that each task owns.
class Hang {
 public:
  Executor::Task Task() {
    return [gate = gate_, begun = begun_](const absl::Status& status) {
      if (!status.ok()) return;
      ++*begun;
      gate.wait();
    };
  }
  // Waits until `count` of the tasks have begun.
  bool AwaitBegun(int count) const {
    return WaitFor([&] { return *begun_ >= count; });
  }
  void LetGo() { promise_.set_value(); }

 private:
  const std::shared_ptr<std::atomic<int>> begun_ = std::make_shared<std::atomic<int>>(0);
  std::promise<void> promise_;
  std::shared_future<void> gate_ = promise_.get_future().share();
};

TEST(ExecutorTest, OthersGoOnBesideTasksThatHang) {
  ManualTime time;
  Executor executor({.threads = 2, .max_waiting = 100, .hangs_after = milliseconds(50)}, time);
  Hang hang;
  for (int i = 0; i < 5; ++i) executor.Submit("", hang.Task());
  std::promise<absl::Status> ran;
  executor.Submit("", [&ran](const absl::Status& status) { ran.set_value(status); });
  for (const int begun : {2, 4}) {
    ASSERT_TRUE(hang.AwaitBegun(begun));
    time.Advance(milliseconds(49));
    const int seen = time.Looks();
    ASSERT_TRUE(WaitFor([&] { return time.Looks() >= seen + 2; }));
    EXPECT_EQ(executor.Hanging(), begun - 2) << "no more than have run for long";
    time.Advance(milliseconds(1));
  }
  EXPECT_TRUE(ran.get_future().get().ok());
  EXPECT_EQ(executor.Hanging(), 4);
  hang.LetGo();
  EXPECT_TRUE(WaitFor([&] { return executor.Hanging() == 0; }))
      << "those that return leave the place to others";
  executor.Stop();
}

TEST(ExecutorTest, WhereTooManyHangWhoWaitsIsRefusedInTime) {
  ManualTime time;
  Executor executor({.threads = 1,
                     .max_waiting = 100,
                     .hangs_after = milliseconds(20),
                     .max_hanging = 2,
                     .max_wait = milliseconds(300)},
                    time);
  Hang hang;
  for (int i = 0; i < 3; ++i) executor.Submit("", hang.Task());
  std::promise<absl::Status> ran;
  executor.Submit("", [&ran](const absl::Status& status) { ran.set_value(status); });
  for (const int begun : {1, 2}) {
    ASSERT_TRUE(hang.AwaitBegun(begun));
    time.Advance(milliseconds(20));
  }
  ASSERT_TRUE(hang.AwaitBegun(3));
  time.Advance(milliseconds(260));
  const absl::Status refused = ran.get_future().get();
  EXPECT_TRUE(absl::IsDeadlineExceeded(refused)) << refused;
  EXPECT_EQ(DetailsOf(refused).reason, "REQUESTS_HANG");
  EXPECT_TRUE(DetailsOf(refused).retry_after.has_value());
  hang.LetGo();
}

TEST(ExecutorTest, StopWaitsForAllThatHangTogether) {
  static ManualTime time;  // static, because threads that the executor abandons outlive the test
  Executor executor({.threads = 2, .max_waiting = 100, .hangs_after = milliseconds(20)}, time);
  Hang hang;
  for (int i = 0; i < 8; ++i) executor.Submit("", hang.Task());
  for (const int begun : {2, 4, 6}) {
    ASSERT_TRUE(hang.AwaitBegun(begun));
    time.Advance(milliseconds(20));
  }
  ASSERT_TRUE(hang.AwaitBegun(8));
  EXPECT_EQ(executor.Hanging(), 6);
  auto stopped = std::async(std::launch::async, [&] { executor.Stop(); });
  // The executor is stopping once it refuses tasks.
  ASSERT_TRUE(WaitFor([&] {
    const auto refused = std::make_shared<std::atomic<bool>>(false);
    executor.Submit("", [refused](const absl::Status& status) {
      *refused = DetailsOf(status).reason == "SHUTTING_DOWN";
    });
    return refused->load();
  }));
  time.Advance(LooseThread::kPatience);
  EXPECT_EQ(stopped.wait_for(testing::kHangLimit), std::future_status::ready)
      << "they have five seconds together";
  hang.LetGo();
}

TEST(ExecutorTest, OwnersTakeTurns) {
  std::mutex mutex;
  std::vector<std::string> order;
  std::promise<void> last;
  ManualTime time;
  {
    Executor executor({.threads = 1, .max_waiting = 100, .max_waiting_each = 100}, time);
    Hang hang;
    executor.Submit("", hang.Task());
    const auto submit = [&](const std::string& owner) {
      executor.Submit(owner, [&, owner](const absl::Status&) {
        time.Advance(milliseconds(2));
        const std::lock_guard lock(mutex);
        order.push_back(owner);
        if (order.size() == 42) last.set_value();
      });
    };
    for (int i = 0; i < 40; ++i) submit("hog");
    for (int i = 0; i < 2; ++i) submit("other");
    hang.LetGo();
    last.get_future().wait();
  }
  EXPECT_EQ(std::count(order.begin(), order.begin() + 8, "other"), 2)
      << "not after the forty that came before";
}

TEST(ExecutorTest, LongTasksOfOneOwnerLeaveAThreadToOthers) {
  std::promise<absl::Status> ran;
  ManualTime time;
  Executor executor({.threads = 3}, time);
  Hang hang;
  for (int i = 0; i < 10; ++i) executor.Submit("hog", hang.Task());
  executor.Submit("other", [&ran](const absl::Status& status) { ran.set_value(status); });
  EXPECT_EQ(ran.get_future().wait_for(testing::kHangLimit), std::future_status::ready);
  hang.LetGo();
}

TEST(ExecutorTest, OneOwnerDoesNotFillTheQueue) {
  std::vector<absl::Status> refused;
  Executor executor({.threads = 0, .max_waiting = 10, .max_waiting_each = 3});
  const auto refuse = [&](const absl::Status& status) { refused.push_back(status); };
  for (int i = 0; i < 5; ++i) executor.Submit("hog", refuse);
  ASSERT_EQ(refused.size(), 2);
  EXPECT_EQ(DetailsOf(refused.front()).reason, "REQUEST_QUEUE_FULL");
  EXPECT_EQ(DetailsOf(refused.front()).metadata.at("maximum"), "3");
  executor.Submit("other", refuse);
  EXPECT_EQ(refused.size(), 2);
}

TEST(ExecutorTest, ATaskWithoutMemoryFailsAlone) {
  std::promise<absl::Status> ran;
  ManualTime time;
  Executor executor({.threads = 1}, time);
  executor.Submit("", [](const absl::Status&) { throw std::bad_alloc(); });
  executor.Submit("", [&ran](const absl::Status& status) { ran.set_value(status); });
  EXPECT_TRUE(ran.get_future().get().ok());
}

TEST(ExecutorTest, ManyTasksRunEachOnce) {
  std::atomic<int> runs{0};
  ManualTime time;
  {
    Executor executor({.threads = 4, .max_waiting = 10'000}, time);
    std::vector<std::jthread> threads;
    for (int i = 0; i < 4; ++i) {
      threads.emplace_back([&] {
        for (int j = 0; j < 1000; ++j) executor.Submit("", [&](const absl::Status&) { ++runs; });
      });
    }
  }
  EXPECT_EQ(runs, 4000) << "run, or refused by Stop";
}

}  // namespace
}  // namespace thunderhead::base
