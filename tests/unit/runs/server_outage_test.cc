#include "runs/server_outage.h"

#include <chrono>

#include "absl/status/status.h"
#include "gtest/gtest.h"
#include "tests/support/manual_time.h"

namespace thunderhead::runs {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

const absl::Status kLost = absl::UnavailableError("the server restarts");

TEST(ServerOutage, LastsAtMostTheMaximumTime) {
  testing::ManualTime time;
  ServerOutage outage(time);
  // The time before the first failure does not count.
  time.Advance(seconds(1000));
  EXPECT_TRUE(outage.MayRetry(kLost));
  time.Advance(ServerOutage::kPatience);
  EXPECT_TRUE(outage.MayRetry(kLost));
  time.Advance(milliseconds(1));
  EXPECT_FALSE(outage.MayRetry(kLost));
}

TEST(ServerOutage, AnAnswerEndsIt) {
  testing::ManualTime time;
  ServerOutage outage(time);
  EXPECT_TRUE(outage.MayRetry(kLost));
  time.Advance(ServerOutage::kPatience);
  outage.End();
  time.Advance(seconds(1));
  EXPECT_TRUE(outage.MayRetry(kLost));
  time.Advance(ServerOutage::kPatience);
  EXPECT_TRUE(outage.MayRetry(kLost));
}

TEST(ServerOutage, APermanentErrorIsNotTriedAgain) {
  testing::ManualTime time;
  ServerOutage outage(time);
  EXPECT_FALSE(outage.MayRetry(absl::InvalidArgumentError("the scene is wrong")));
  EXPECT_TRUE(outage.MayRetry(kLost));
}

}  // namespace
}  // namespace thunderhead::runs
