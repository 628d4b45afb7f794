#include "base/patient_calls.h"

#include <future>
#include <memory>
#include <new>
#include <thread>

#include "absl/status/statusor.h"
#include "base/error_details.h"
#include "base/stopwatch.h"
#include "gtest/gtest.h"

namespace thunderhead::base {
namespace {

TEST(PatientCallsTest, WaitsForACallThatReturns) {
  PatientCalls calls(std::chrono::seconds(20));
  const auto ran = std::make_shared<bool>(false);
  EXPECT_TRUE(calls.Run("/data", [ran] { *ran = true; }).ok());
  EXPECT_TRUE(*ran);
}

TEST(PatientCallsTest, AStorageThatHangsHoldsUpOnceAndNoOtherStorage) {
  PatientCalls calls(std::chrono::milliseconds(100));
  std::promise<void> storage;
  const std::shared_future<void> answers = storage.get_future().share();
  const auto hang = [answers] { answers.wait(); };
  const absl::Status hangs = calls.Run("/mnt/gone", hang);
  EXPECT_TRUE(absl::IsDeadlineExceeded(hangs)) << hangs;
  EXPECT_EQ(DetailsOf(hangs).reason, "STORAGE_HANGS");
  EXPECT_TRUE(DetailsOf(hangs).retry_after.has_value());
  const Stopwatch stopwatch;
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(calls.Run("/mnt/gone", hang).ok());
  EXPECT_LT(stopwatch.ElapsedMs(), 1000.0) << "that it hangs is known";
  EXPECT_TRUE(calls.Run("/data", [] {}).ok());
  storage.set_value();
  for (int i = 0; i < 100 && !calls.Run("/mnt/gone", [] {}).ok(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_TRUE(calls.Run("/mnt/gone", [] {}).ok()) << "it answers again";
}

TEST(PatientCallsTest, GivesWhatTheCallGaveOrThrew) {
  PatientCalls calls(std::chrono::seconds(20));
  const auto given = calls.Ask("/data", []() -> absl::StatusOr<int> { return 7; });
  ASSERT_TRUE(given.ok()) << given.status();
  EXPECT_EQ(*given, 7);
  const auto failed = calls.Ask("/data", [] { return absl::DataLossError("damaged"); });
  EXPECT_TRUE(absl::IsDataLoss(failed)) << failed;
  EXPECT_THROW((void)calls.Run("/data", [] { throw std::bad_alloc(); }), std::bad_alloc);
}

TEST(PatientCallsTest, TellsForHowLongAStorageHasHung) {
  PatientCalls calls(std::chrono::milliseconds(100));
  std::promise<void> storage;
  EXPECT_TRUE(calls.Run("/data", [] {}).ok());
  EXPECT_EQ(calls.HangingSeconds(), 0.0);
  const auto hang = [answers = storage.get_future().share()] { answers.wait(); };
  EXPECT_FALSE(calls.Run("/mnt/gone", hang).ok());
  EXPECT_GE(calls.HangingSeconds(), 0.1);
  storage.set_value();
  for (int i = 0; i < 1000 && calls.HangingSeconds() > 0.0; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_EQ(calls.HangingSeconds(), 0.0) << "it answers again";
}

TEST(PatientCallsTest, WhatHangsIsLeftBehindAtTheEnd) {
  const auto storage = std::make_shared<std::promise<void>>();
  const Stopwatch ending;
  {
    PatientCalls calls(std::chrono::milliseconds(100));
    const auto hang = [storage, answers = storage->get_future().share()] { answers.wait(); };
    EXPECT_FALSE(calls.Run("/mnt/gone", hang).ok());
  }
  EXPECT_LT(ending.ElapsedMs(), 3000.0) << "it had its time";
  storage->set_value();
}

}  // namespace
}  // namespace thunderhead::base
