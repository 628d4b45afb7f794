// Tests the one table that makes gRPC's status, with google.rpc's details, of every error.
#include "rpc_port/status_table.h"

#include <chrono>
#include <string>

#include "base/error_details.h"
#include "base/memory_budget.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/decoded_details.h"

namespace thunderhead::rpc_port {
namespace {

using testing::Decode;
using testing::Decoded;

TEST(StatusTableTest, EveryEngineStatusHasItsCode) {
  const auto code = [](const absl::Status& status) { return ToGrpcStatus(status).error_code(); };
  EXPECT_TRUE(ToGrpcStatus(absl::OkStatus()).ok());
  EXPECT_EQ(code(absl::InvalidArgumentError("x")), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(code(absl::OutOfRangeError("x")), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(code(absl::NotFoundError("x")), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(code(absl::DataLossError("x")), grpc::StatusCode::DATA_LOSS);
  EXPECT_EQ(code(absl::UnauthenticatedError("x")), grpc::StatusCode::UNAUTHENTICATED);
  EXPECT_EQ(code(absl::UnknownError("x")), grpc::StatusCode::UNKNOWN);
  EXPECT_EQ(ToGrpcStatus(absl::InternalError("why")).error_message(), "why");
}

TEST(StatusTableTest, WhatWouldBeRefusedAgainHasNoTimeToTryAgain) {
  const absl::Status refused = absl::ResourceExhaustedError("why");
  EXPECT_EQ(Decode(ToGrpcStatus(base::WithDetails(refused, {.reason = "A"}))).retry_s, 30.0);
  const auto permanent = Decode(
      ToGrpcStatus(base::WithDetails(refused, {.reason = "STORM_UNREADABLE", .permanent = true})));
  EXPECT_LT(permanent.retry_s, 0.0);
  EXPECT_EQ(permanent.reason, "STORM_UNREADABLE");
  // This picture needs more memory than the whole budget.
  const auto budget = base::MemoryBudget::Make({.bytes = 1000});
  const absl::Status too_large =
      budget->Reserve(base::MemoryUse::kDrawing, 2000, "a picture").status();
  EXPECT_LT(Decode(ToGrpcStatus(too_large)).retry_s, 0.0);
}

TEST(StatusTableTest, EveryRefusalHasDetails) {
  for (int code = 1; code <= 16; ++code) {
    const absl::Status status(static_cast<absl::StatusCode>(code), "why");
    const grpc::Status sent = ToGrpcStatus(status);
    EXPECT_EQ(sent.error_message(), "why");
    if (absl::IsCancelled(status)) continue;
    const Decoded decoded = Decode(sent);
    EXPECT_THAT(decoded.reason, ::testing::MatchesRegex("[A-Z][A-Z_]+[A-Z]")) << code;
    EXPECT_EQ(decoded.bad_request, sent.error_code() == grpc::StatusCode::INVALID_ARGUMENT);
    EXPECT_EQ(decoded.retry_s > 0.0,
              absl::IsResourceExhausted(status) || absl::IsUnavailable(status));
  }
}

TEST(StatusTableTest, ADelayKeepsItsFraction) {
  const absl::Status status = base::WithDetails(absl::UnavailableError("busy"),
                                                {.retry_after = std::chrono::milliseconds(1250)});
  EXPECT_EQ(Decode(ToGrpcStatus(status)).retry_s, 1.25);
}

TEST(StatusTableTest, BytesThatAreNoUtf8AreReplaced) {
  const auto sent = [](const std::string& text) {
    const grpc::Status status = ToGrpcStatus(absl::InternalError(text));
    EXPECT_EQ(Decode(status).reason, "INTERNAL");
    return status.error_message();
  };
  EXPECT_EQ(sent("plain, ä ☀ 🌩"), "plain, ä ☀ 🌩");
  EXPECT_EQ(sent("plain\n"), "plain?") << "a control character";
  EXPECT_EQ(sent("Gew\xf6lk"), "Gew?lk") << "Latin-1";
  EXPECT_EQ(sent("\xc3"), "?") << "cut off";
  EXPECT_EQ(sent("\xc0\xaf"), "??") << "longer than needed";
  EXPECT_EQ(sent("\xe0\x80\xaf"), "???") << "longer than needed";
  EXPECT_EQ(sent("\xed\xa0\x80"), "???") << "half of a pair";
  EXPECT_EQ(sent("\xf4\x90\x80\x80"), "????") << "beyond Unicode";
}

}  // namespace
}  // namespace thunderhead::rpc_port
