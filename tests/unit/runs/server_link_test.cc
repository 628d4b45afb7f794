#include "runs/server_link.h"

#include <stop_token>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::runs {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class ServerLinkTest : public ::testing::Test {
 protected:
  // No call is made, so nothing has to listen at this address.
  ServerLink link_{{.address = "127.0.0.1:1", .token = "", .tls_roots = ""}};

  absl::Status StatusOf(grpc::StatusCode code, const std::string& text) const {
    return link_.StatusOf(grpc::Status(code, text));
  }
};

TEST_F(ServerLinkTest, SaysWhetherTheServerCannotBeReachedOrIsSlow) {
  const absl::Status away = StatusOf(grpc::StatusCode::UNAVAILABLE, "refused");
  EXPECT_TRUE(absl::IsUnavailable(away));
  EXPECT_THAT(std::string(away.message()),
              HasSubstr("the server at 127.0.0.1:1 cannot be reached"));
  const absl::Status slow = StatusOf(grpc::StatusCode::DEADLINE_EXCEEDED, "too late");
  EXPECT_TRUE(absl::IsDeadlineExceeded(slow));
  EXPECT_THAT(std::string(slow.message()),
              HasSubstr("the server at 127.0.0.1:1 has not answered in time"));
  EXPECT_THAT(std::string(slow.message()), Not(HasSubstr("reached")));
}

TEST_F(ServerLinkTest, AMissingCallNeedNotBeOneOfRenderJobs) {
  const absl::Status missing = StatusOf(grpc::StatusCode::UNIMPLEMENTED, "no ListStorms");
  EXPECT_TRUE(absl::IsUnimplemented(missing));
  EXPECT_EQ(missing.message(),
            "the server at 127.0.0.1:1 lacks a call that this program needs; run both in the same "
            "version (no ListStorms)");
}

TEST_F(ServerLinkTest, AStopIsNoFaultOfTheServer) {
  std::stop_source stop;
  link_.StopOn(stop.get_token());
  stop.request_stop();
  EXPECT_TRUE(absl::IsCancelled(StatusOf(grpc::StatusCode::DEADLINE_EXCEEDED, "")));
}

}  // namespace
}  // namespace thunderhead::runs
