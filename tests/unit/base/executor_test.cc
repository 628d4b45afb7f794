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
#include "base/stopwatch.h"
#include "gtest/gtest.h"

namespace thunderhead::base {
namespace {

using std::chrono::milliseconds;

// Tasks that hang until they are let go, with what they own.
class Hang {
 public:
  Executor::Task Task() {
    return [gate = gate_](const absl::Status& status) {
      if (status.ok()) gate.wait();
    };
  }
  void LetGo() { promise_.set_value(); }

 private:
  std::promise<void> promise_;
  std::shared_future<void> gate_ = promise_.get_future().share();
};

TEST(ExecutorTest, OthersGoOnBesideTasksThatHang) {
  Executor executor({.threads = 2, .max_waiting = 100, .hangs_after = milliseconds(50)});
  Hang hang;
  for (int i = 0; i < 5; ++i) executor.Submit("", hang.Task());
  std::promise<absl::Status> ran;
  executor.Submit("", [&ran](const absl::Status& status) { ran.set_value(status); });
  auto done = ran.get_future();
  ASSERT_EQ(done.wait_for(std::chrono::seconds(10)), std::future_status::ready);
  EXPECT_TRUE(done.get().ok());
  EXPECT_GE(executor.Hanging(), 4);
  hang.LetGo();
  for (int i = 0; i < 1000 && executor.Hanging() > 0; ++i) {
    std::this_thread::sleep_for(milliseconds(5));
  }
  EXPECT_EQ(executor.Hanging(), 0) << "those that return leave the place to others";
  executor.Stop();
}

TEST(ExecutorTest, WhereTooManyHangWhoWaitsIsRefusedInTime) {
  Executor executor({.threads = 1,
                     .max_waiting = 100,
                     .hangs_after = milliseconds(20),
                     .max_hanging = 2,
                     .max_wait = milliseconds(300)});
  Hang hang;
  for (int i = 0; i < 3; ++i) executor.Submit("", hang.Task());
  std::promise<absl::Status> ran;
  executor.Submit("", [&ran](const absl::Status& status) { ran.set_value(status); });
  auto done = ran.get_future();
  ASSERT_EQ(done.wait_for(std::chrono::seconds(10)), std::future_status::ready);
  const absl::Status refused = done.get();
  EXPECT_TRUE(absl::IsDeadlineExceeded(refused)) << refused;
  EXPECT_EQ(DetailsOf(refused).reason, "REQUESTS_HANG");
  EXPECT_TRUE(DetailsOf(refused).retry_after.has_value());
  hang.LetGo();
}

TEST(ExecutorTest, StopWaitsForAllThatHangTogether) {
  Executor executor({.threads = 2, .max_waiting = 100, .hangs_after = milliseconds(20)});
  Hang hang;
  for (int i = 0; i < 8; ++i) executor.Submit("", hang.Task());
  for (int i = 0; i < 1000 && executor.Hanging() < 6; ++i) {
    std::this_thread::sleep_for(milliseconds(5));
  }
  EXPECT_GE(executor.Hanging(), 6);
  const Stopwatch stopwatch;
  executor.Stop();
  EXPECT_LT(stopwatch.ElapsedMs(), 15'000.0) << "each has five seconds";
  hang.LetGo();
}

TEST(ExecutorTest, OwnersTakeTurns) {
  std::mutex mutex;
  std::vector<std::string> order;
  std::promise<void> last;
  {
    Executor executor({.threads = 1, .max_waiting = 100, .max_waiting_each = 100});
    Hang hang;
    executor.Submit("", hang.Task());
    const auto submit = [&](const std::string& owner) {
      executor.Submit(owner, [&, owner](const absl::Status&) {
        std::this_thread::sleep_for(milliseconds(2));
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
  Executor executor({.threads = 3});
  Hang hang;
  for (int i = 0; i < 10; ++i) executor.Submit("hog", hang.Task());
  executor.Submit("other", [&ran](const absl::Status& status) { ran.set_value(status); });
  auto done = ran.get_future();
  EXPECT_EQ(done.wait_for(std::chrono::seconds(10)), std::future_status::ready);
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
  Executor executor({.threads = 1});
  executor.Submit("", [](const absl::Status&) { throw std::bad_alloc(); });
  executor.Submit("", [&ran](const absl::Status& status) { ran.set_value(status); });
  EXPECT_TRUE(ran.get_future().get().ok());
}

TEST(ExecutorTest, ManyTasksRunEachOnce) {
  std::atomic<int> runs{0};
  {
    Executor executor({.threads = 4, .max_waiting = 10'000});
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
