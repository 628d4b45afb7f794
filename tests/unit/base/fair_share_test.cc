#include "base/fair_share.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace thunderhead::base {
namespace {

const std::vector<std::string> kBoth = {"pipeline", "ben"};

// Serves `owner` with a task that is charged and takes `ms`.
void Serve(FairShare& shares, const std::string& owner, double ms) {
  shares.Charge(owner, ms);
  shares.Settle(owner, ms, ms);
}

TEST(FairShareTest, TheClientThatHasUsedTheLeastTimeIsNext) {
  FairShare shares;
  EXPECT_EQ(shares.Next(kBoth), "pipeline");
  Serve(shares, "pipeline", 30.0);
  EXPECT_EQ(shares.Next(kBoth), "ben");
  Serve(shares, "ben", 50.0);
  EXPECT_EQ(shares.Next(kBoth), "pipeline");
  EXPECT_EQ(shares.Next(kBoth, [](const std::string& one) { return one == "ben"; }), "ben");
  EXPECT_EQ(shares.Next(kBoth, [](const std::string&) { return false; }), std::nullopt);
}

// A newcomer must not inherit a charge that turns out to be too high. Otherwise it waits until the
// others have used as much time as was charged by mistake.
TEST(FairShareTest, ANewcomerDoesNotWaitForTheCorrectionOfAnotherClientsCharge) {
  FairShare shares;
  EXPECT_EQ(shares.Next({"pipeline"}), "pipeline");
  shares.Charge("pipeline", 900.0);
  EXPECT_EQ(shares.Next(kBoth), "ben");
  shares.Charge("ben", 40.0);
  shares.Settle("pipeline", 900.0, 40.0);
  shares.Settle("ben", 40.0, 40.0);
  int before_ben = 0;
  while (shares.Next(kBoth) != "ben" && before_ben < 10) {
    Serve(shares, "pipeline", 40.0);
    ++before_ben;
  }
  EXPECT_LE(before_ben, 1);
}

TEST(FairShareTest, AChargeCountsUntilItIsSettled) {
  FairShare shares;
  EXPECT_EQ(shares.Next(kBoth), "pipeline");
  shares.Charge("pipeline", 10.0);
  EXPECT_EQ(shares.Next(kBoth), "ben");
  shares.Charge("ben", 20.0);
  EXPECT_EQ(shares.Next(kBoth), "pipeline");
  shares.Settle("ben", 20.0, 0.0);  // the task was dropped
  EXPECT_EQ(shares.Next(kBoth), "ben");
}

TEST(FairShareTest, AClientThatReturnsHasNoAdvantage) {
  FairShare shares;
  EXPECT_EQ(shares.Next(kBoth), "pipeline");
  Serve(shares, "pipeline", 500.0);
  Serve(shares, "ben", 500.0);
  EXPECT_EQ(shares.Next({"pipeline"}), "pipeline");
  Serve(shares, "pipeline", 10.0);
  shares.Charge("ben", 5.0);  // ben was forgotten, so nothing is charged
  EXPECT_EQ(shares.Next(kBoth), "pipeline");
  Serve(shares, "pipeline", 10.0);
  EXPECT_EQ(shares.Next(kBoth), "ben");
}

}  // namespace
}  // namespace thunderhead::base
