// Tests that details stay with a status as it is passed on, and that the innermost details win.
#include "base/error_details.h"

#include <chrono>

#include "base/executor.h"
#include "base/status.h"
#include "gtest/gtest.h"

namespace thunderhead::base {
namespace {

using std::chrono::milliseconds;

const ErrorDetails kAll = {.reason = "TOO_DEEP",
                           .field = "pond.depth_m",
                           .description = "is 9; it must be below 3 m",
                           .metadata = {{"maximum", "3"}, {"unit", "m"}},
                           .retry_after = milliseconds(1500)};

void ExpectAll(const absl::Status& status) {
  const ErrorDetails details = DetailsOf(status);
  EXPECT_EQ(details.reason, kAll.reason);
  EXPECT_EQ(details.field, kAll.field);
  EXPECT_EQ(details.description, kAll.description);
  EXPECT_EQ(details.metadata, kAll.metadata);
  EXPECT_EQ(details.retry_after, kAll.retry_after);
}

absl::Status PassOn(const absl::Status& status) {
  THUNDERHEAD_RETURN_IF_ERROR(status);
  return absl::OkStatus();
}

absl::Status AssignAndPassOn(const absl::Status& status) {
  THUNDERHEAD_ASSIGN_OR_RETURN([[maybe_unused]] const int depth_m, absl::StatusOr<int>(status));
  return absl::OkStatus();
}

TEST(ErrorDetails, ComeBackFromEveryWayThatAStatusTakes) {
  const absl::Status status = WithDetails(absl::OutOfRangeError("too deep"), kAll);
  EXPECT_EQ(status.code(), absl::StatusCode::kOutOfRange);
  EXPECT_EQ(status.message(), "too deep");
  ExpectAll(status);
  ExpectAll(PassOn(status));
  ExpectAll(AssignAndPassOn(status));
  ExpectAll(Annotate(status, "the garden"));
  EXPECT_EQ(Annotate(status, "the garden").message(), "the garden: too deep");
}

TEST(ErrorDetails, WhatIsThereStays) {
  const absl::Status status = WithDetails(WithDetails(absl::OutOfRangeError("too deep"), kAll),
                                          {.reason = "OTHER",
                                           .field = "garden",
                                           .description = "is odd",
                                           .metadata = {{"unit", "ft"}},
                                           .retry_after = milliseconds(1)});
  ExpectAll(status);
}

TEST(ErrorDetails, WhatIsMissingIsAdded) {
  const absl::Status status =
      WithDetails(WithDetails(absl::OutOfRangeError("too deep"),
                              {.field = "pond", .metadata = {{"maximum", "3"}}}),
                  {.reason = "TOO_DEEP",
                   .field = "garden",
                   .description = "is odd",
                   .metadata = {{"unit", "m"}}});
  const ErrorDetails details = DetailsOf(status);
  EXPECT_EQ(details.reason, "TOO_DEEP");
  EXPECT_EQ(details.metadata, kAll.metadata);
  EXPECT_EQ(details.field, "pond");
  EXPECT_EQ(details.description, "") << "that is of another field";
  EXPECT_EQ(details.retry_after, std::nullopt);
}

TEST(ErrorDetails, NothingIsWrongWithOk) { EXPECT_EQ(WithDetails({}, kAll), absl::OkStatus()); }

TEST(ErrorDetails, AnInvalidFieldIsNamedInTheMessage) {
  const absl::Status status =
      InvalidField(kAll.field, kAll.description, kAll.reason, kAll.metadata);
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(status.message(), "pond.depth_m is 9; it must be below 3 m");
  ExpectAll(WithDetails(status, {.retry_after = kAll.retry_after}));
}

TEST(Executor, SaysWhyItRefusesAndWhenToComeAgain) {
  Executor executor({.threads = 0, .max_waiting = 1});  // without threads no task ever runs
  absl::Status first;
  absl::Status second;
  executor.Submit("", [&](const absl::Status& status) { first = status; });
  executor.Submit("", [&](const absl::Status& status) { second = status; });
  EXPECT_EQ(second.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(DetailsOf(second).reason, "REQUEST_QUEUE_FULL");
  EXPECT_EQ(DetailsOf(second).metadata.at("maximum"), "1");
  EXPECT_EQ(DetailsOf(second).retry_after, std::chrono::seconds(10));
  executor.Stop();
  EXPECT_EQ(first.code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(DetailsOf(first).reason, "SHUTTING_DOWN");
  EXPECT_EQ(DetailsOf(first).retry_after, std::chrono::seconds(5));
}

}  // namespace
}  // namespace thunderhead::base
