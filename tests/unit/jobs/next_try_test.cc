// Tests that a job retries after temporary errors, and gives up after permanent ones.
#include "jobs/next_try.h"

#include "base/error_details.h"
#include "gtest/gtest.h"
#include "jobs/job_board.h"

namespace thunderhead::jobs {
namespace {

using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;

absl::Status With(absl::StatusCode code, const char* reason,
                  std::optional<milliseconds> retry_after = {}) {
  return base::WithDetails(absl::Status(code, "why"),
                           {.reason = reason, .retry_after = retry_after});
}

TEST(NextTry, AServerThatStopsOrIsFullDoesNotCount) {
  for (const char* reason : {"SHUTTING_DOWN", "RENDER_QUEUE_FULL"}) {
    const auto next =
        NextTryAfter(With(absl::StatusCode::kUnavailable, reason, seconds(5)), 5, false);
    ASSERT_TRUE(next.has_value()) << reason;
    EXPECT_FALSE(next->counts);
  }
  const auto drained = NextTryAfter(absl::CancelledError("drained"), 5, true);
  ASSERT_TRUE(drained.has_value());
  EXPECT_FALSE(drained->counts);
}

TEST(NextTry, AStorageThatHangsIsWaitedForHoweverLong) {
  const absl::Status hangs =
      With(absl::StatusCode::kDeadlineExceeded, "STORAGE_HANGS", seconds(10));
  for (const int attempts : {1, JobBoard::kMaxAttempts, 100}) {
    const auto next = NextTryAfter(hangs, attempts, false);
    ASSERT_TRUE(next.has_value());
    EXPECT_FALSE(next->counts);
    EXPECT_EQ(next->pause, seconds(10));
  }
}

TEST(NextTry, WhatSaysWhenToTryAgainIsTriedWithGrowingPauses) {
  for (const char* reason : {"MEMORY_BUDGET", "OUT_OF_MEMORY", "OUT_OF_DEVICE_MEMORY"}) {
    const absl::Status full = With(absl::StatusCode::kResourceExhausted, reason, seconds(30));
    EXPECT_EQ(NextTryAfter(full, 1, false)->pause, seconds(30)) << reason;
    EXPECT_EQ(NextTryAfter(full, 3, false)->pause, seconds(120)) << reason;
    EXPECT_TRUE(NextTryAfter(full, 1, false)->counts) << reason;
    EXPECT_FALSE(NextTryAfter(full, JobBoard::kMaxAttempts, false).has_value()) << reason;
  }
  const absl::Status lost = absl::UnavailableError("the device was lost");
  EXPECT_EQ(NextTryAfter(lost, 1, false)->pause, seconds(5));
  EXPECT_EQ(NextTryAfter(With(absl::StatusCode::kUnavailable, "", minutes(4)), 2, false)->pause,
            minutes(5));
}

TEST(NextTry, WhatAnotherTryDoesNotHelpEndsThePicture) {
  EXPECT_FALSE(NextTryAfter(absl::InvalidArgumentError("a bad scene"), 1, false).has_value());
  EXPECT_FALSE(NextTryAfter(absl::DataLossError("a damaged file"), 1, false).has_value());
  EXPECT_FALSE(NextTryAfter(absl::DeadlineExceededError("too long"), 1, false).has_value());
  // The job gives up at these errors, although the error tells clients to try again in an hour.
  for (const char* reason : {"PICTURE_TOO_LARGE", "TOO_MANY_SAMPLES"}) {
    const absl::Status large = With(absl::StatusCode::kResourceExhausted, reason, minutes(60));
    EXPECT_FALSE(NextTryAfter(large, 1, false).has_value()) << reason;
  }
}

}  // namespace
}  // namespace thunderhead::jobs
