#include "base/timed_calls.h"

#include <pthread.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <future>
#include <memory>
#include <new>

#include "absl/status/statusor.h"
#include "base/error_details.h"
#include "gtest/gtest.h"
#include "tests/support/manual_time.h"
#include "tests/support/wait_for.h"

namespace thunderhead::base {
namespace {

using std::chrono::milliseconds;
using testing::ManualTime;
using testing::WaitFor;

constexpr milliseconds kPatience{100};

// A simulated storage. Calls to it hang until the test lets it respond.
class Storage {
 public:
  std::function<void()> Call() {
    return [begun = begun_, answers = answers_] {
      ++*begun;
      answers.wait();
    };
  }
  int Begun() const { return *begun_; }
  void Answer() { storage_.set_value(); }

 private:
  const std::shared_ptr<std::atomic<int>> begun_ = std::make_shared<std::atomic<int>>(0);
  std::promise<void> storage_;
  const std::shared_future<void> answers_ = storage_.get_future().share();
};

// Calls the storage while time passes, until the timeout.
absl::Status CallInVain(TimedCalls& calls, Storage& storage, ManualTime& time) {
  const int begun = storage.Begun();
  auto hangs =
      std::async(std::launch::async, [&] { return calls.Run("/mnt/gone", storage.Call()); });
  EXPECT_TRUE(WaitFor([&] { return storage.Begun() > begun; }));
  time.Advance(kPatience - milliseconds(1));
  const auto has_ended = [&] {
    return hangs.wait_for(milliseconds(0)) == std::future_status::ready;
  };
  const int seen = time.Looks();
  EXPECT_TRUE(WaitFor([&] { return time.Looks() >= seen + 2 || has_ended(); }));
  EXPECT_FALSE(has_ended());
  time.Advance(milliseconds(1));
  return hangs.get();
}

// The test makes the creation of a thread fail by requesting a stack that no system has space for.
// A limited address space has the same effect.
TEST(TimedCallsTest, ACallForWhichThereIsNoThreadIsRefused) {
  pthread_attr_t usual;
  pthread_attr_t huge;
  ASSERT_EQ(pthread_getattr_default_np(&usual), 0);
  ASSERT_EQ(pthread_getattr_default_np(&huge), 0);
  ASSERT_EQ(pthread_attr_setstacksize(&huge, std::size_t{1} << 47), 0);
  ASSERT_EQ(pthread_setattr_default_np(&huge), 0);
  TimedCalls calls(kPatience);
  bool called = false;
  const absl::Status refused = calls.Run("/mnt/state", [&called] { called = true; });
  ASSERT_EQ(pthread_setattr_default_np(&usual), 0);
  EXPECT_TRUE(absl::IsResourceExhausted(refused)) << refused;
  EXPECT_FALSE(called);
  EXPECT_TRUE(calls.Run("/mnt/state", [&called] { called = true; }).ok());
  EXPECT_TRUE(called);
  pthread_attr_destroy(&usual);
  pthread_attr_destroy(&huge);
}

TEST(TimedCallsTest, WaitsForACallThatReturns) {
  const ManualTime time;
  TimedCalls calls(kPatience, time);
  const auto ran = std::make_shared<bool>(false);
  EXPECT_TRUE(calls.Run("/data", [ran] { *ran = true; }).ok());
  EXPECT_TRUE(*ran);
}

TEST(TimedCallsTest, AStorageThatHangsHoldsUpOnceAndNoOtherStorage) {
  ManualTime time;
  TimedCalls calls(kPatience, time);
  Storage storage;
  const absl::Status hangs = CallInVain(calls, storage, time);
  EXPECT_TRUE(absl::IsDeadlineExceeded(hangs)) << hangs;
  EXPECT_EQ(DetailsOf(hangs).reason, "STORAGE_HANGS");
  EXPECT_TRUE(DetailsOf(hangs).retry_after.has_value());
  // The storage is known to hang, so these calls end at once, although no time passes.
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(calls.Run("/mnt/gone", storage.Call()).ok());
  EXPECT_EQ(storage.Begun(), 1);
  EXPECT_TRUE(calls.Run("/data", [] {}).ok());
  storage.Answer();
  EXPECT_TRUE(WaitFor([&] { return calls.Run("/mnt/gone", [] {}).ok(); })) << "it answers again";
}

TEST(TimedCallsTest, GivesWhatTheCallGaveOrThrew) {
  const ManualTime time;
  TimedCalls calls(kPatience, time);
  const auto given = calls.Ask("/data", []() -> absl::StatusOr<int> { return 7; });
  ASSERT_TRUE(given.ok()) << given.status();
  EXPECT_EQ(*given, 7);
  const auto failed = calls.Ask("/data", [] { return absl::DataLossError("damaged"); });
  EXPECT_TRUE(absl::IsDataLoss(failed)) << failed;
  EXPECT_THROW((void)calls.Run("/data", [] { throw std::bad_alloc(); }), std::bad_alloc);
}

TEST(TimedCallsTest, TellsForHowLongAStorageHasHung) {
  ManualTime time;
  TimedCalls calls(kPatience, time);
  Storage storage;
  EXPECT_TRUE(calls.Run("/data", [] {}).ok());
  EXPECT_EQ(calls.HangingSeconds(), 0.0);
  EXPECT_FALSE(CallInVain(calls, storage, time).ok());
  EXPECT_DOUBLE_EQ(calls.HangingSeconds(), 0.1);
  time.Advance(std::chrono::seconds(2));
  EXPECT_DOUBLE_EQ(calls.HangingSeconds(), 2.1);
  storage.Answer();
  EXPECT_TRUE(WaitFor([&] { return calls.HangingSeconds() == 0.0; })) << "it answers again";
}

TEST(TimedCallsTest, WhatHangsIsLeftBehindAtTheEnd) {
  // The clock is static, because the call outlives the test.
  static ManualTime time;
  Storage storage;
  {
    TimedCalls calls(kPatience, time);
    EXPECT_FALSE(CallInVain(calls, storage, time).ok());
    // The destructor returns while time stands still, because the call has already timed out.
  }
  storage.Answer();
}

}  // namespace
}  // namespace thunderhead::base
