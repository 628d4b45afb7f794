// Tests a call that only tests/extending knows, added to the files that docs/extending.md names. A
// client calls it on a server with access control.
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/service/guarded_service.h"

namespace thunderhead::testing {
namespace {

using ::testing::HasSubstr;
using Stub = v1::ThunderheadService::Stub;

class CallToyTest : public ::testing::Test {
 protected:
  grpc::Status Count(const std::string& role, const v1::CountStormsRequest& request = {}) {
    return guarded_.Call(role, &Stub::CountStorms, request, &response_);
  }

  GuardedService guarded_;
  v1::CountStormsResponse response_;
};

TEST_F(CallToyTest, IsAnsweredByItsHandler) {
  const std::size_t storms = guarded_.service().store->Storms().size();
  ASSERT_GT(storms, 1U);
  ASSERT_TRUE(Count("viewer").ok());
  EXPECT_EQ(response_.storms(), storms);
  v1::CountStormsRequest request;
  request.set_at_most(1);
  ASSERT_TRUE(Count("operator", request).ok());
  EXPECT_EQ(response_.storms(), 1U);
}

TEST_F(CallToyTest, ItsLimitsAreThoseOfItsMessage) {
  v1::CountStormsRequest request;
  request.set_at_most(101);
  const grpc::Status status = Count("viewer", request);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), HasSubstr("at_most is 101; it must be between 1 and 100"));
}

TEST_F(CallToyTest, OnlyRolesOfItsRuleMayCallIt) {
  EXPECT_TRUE(Count("presenter").ok());
  EXPECT_EQ(Count("pipeline").error_code(), grpc::StatusCode::PERMISSION_DENIED);
  EXPECT_EQ(guarded_.Ask("CountStorms", ""), grpc::StatusCode::UNAUTHENTICATED);
}

TEST_F(CallToyTest, OtherCallsAreAnsweredAsBefore) {
  v1::ListStormsResponse listed;
  ASSERT_TRUE(guarded_.Call("viewer", &Stub::ListStorms, v1::ListStormsRequest(), &listed).ok());
  EXPECT_EQ(listed.storms_size(), 2);
}

}  // namespace
}  // namespace thunderhead::testing
