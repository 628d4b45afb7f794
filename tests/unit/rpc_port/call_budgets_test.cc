// Tests which client networks are blocked because they begin too many calls.
#include "rpc_port/call_budgets.h"

#include <poll.h>

#include <chrono>
#include <memory>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/manual_time.h"

namespace thunderhead::rpc_port {
namespace {

using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr double kPerSecond = 10.0;
constexpr int kBurst = 20;

class CallBudgetsTest : public ::testing::Test {
 protected:
  std::shared_ptr<CallBudgets> Open(double per_second = kPerSecond) const {
    return *CallBudgets::Open(per_second, *base::TrustedProxies::Parse({"198.51.100.7"}), time_);
  }
  static void Begin(CallBudgets& budgets, int calls, const std::string& peer) {
    for (int i = 0; i < calls; ++i) budgets.Begin(peer);
  }
  static bool Signals(const CallBudgets& budgets) {
    pollfd wait{budgets.Signal(), POLLIN, 0};
    return poll(&wait, 1, 0) == 1;
  }

  testing::ManualTime time_;
};

TEST_F(CallBudgetsTest, ANetworkIsBlockedBeyondItsBudget) {
  const auto budgets = Open();
  Begin(*budgets, kBurst, "192.0.2.1:1");
  EXPECT_FALSE(budgets->IsBlocked("192.0.2.1:1"));
  EXPECT_FALSE(Signals(*budgets));
  budgets->Begin("192.0.2.1:2");
  EXPECT_TRUE(budgets->IsBlocked("192.0.2.1:3")) << "all connections of the address";
  EXPECT_FALSE(budgets->IsBlocked("192.0.2.2:1"));
  EXPECT_TRUE(Signals(*budgets));
  EXPECT_THAT(budgets->TakeNewlyBlocked(), ElementsAre("192.0.2.1:2"));
  EXPECT_FALSE(Signals(*budgets));
}

TEST_F(CallBudgetsTest, ABlockedNetworkIsReportedOnce) {
  const auto budgets = Open();
  Begin(*budgets, 10 * kBurst, "192.0.2.1:1");
  EXPECT_THAT(budgets->TakeNewlyBlocked(), ElementsAre("192.0.2.1:1"));
  Begin(*budgets, 10 * kBurst, "192.0.2.1:1");
  EXPECT_THAT(budgets->TakeNewlyBlocked(), IsEmpty());
}

TEST_F(CallBudgetsTest, ABlockEndsASecondAfterTheLastCallBeyondTheBudget) {
  const auto budgets = Open();
  Begin(*budgets, kBurst + 1, "192.0.2.1:1");
  time_.Advance(milliseconds(50));
  budgets->Begin("192.0.2.1:1");
  time_.Advance(milliseconds(999));
  EXPECT_TRUE(budgets->IsBlocked("192.0.2.1:1"));
  time_.Advance(milliseconds(1));
  EXPECT_FALSE(budgets->IsBlocked("192.0.2.1:1"));
  budgets->TakeNewlyBlocked();
  // The budget has refilled for more than a second.
  Begin(*budgets, 10, "192.0.2.1:1");
  EXPECT_FALSE(budgets->IsBlocked("192.0.2.1:1"));
  budgets->Begin("192.0.2.1:9");
  EXPECT_THAT(budgets->TakeNewlyBlocked(), ElementsAre("192.0.2.1:9"));
}

TEST_F(CallBudgetsTest, ASteadyRateWithinTheBudgetIsNotBlocked) {
  const auto budgets = Open();
  for (int i = 0; i < 1000; ++i) {
    budgets->Begin("192.0.2.1:1");
    time_.Advance(milliseconds(100));
  }
  EXPECT_FALSE(budgets->IsBlocked("192.0.2.1:1"));
}

TEST_F(CallBudgetsTest, AddressesOfOneNetworkOfIpv6ShareABudget) {
  const auto budgets = Open();
  Begin(*budgets, kBurst, "[2001:db8::1]:1");
  budgets->Begin("[2001:db8::2]:1");
  EXPECT_TRUE(budgets->IsBlocked("[2001:db8::3]:1"));
  EXPECT_FALSE(budgets->IsBlocked("[2001:db8:0:1::1]:1"));
}

TEST_F(CallBudgetsTest, TrustedProxiesHaveNoLimit) {
  const auto budgets = Open();
  Begin(*budgets, 10 * kBurst, "198.51.100.7:1");
  EXPECT_FALSE(budgets->IsBlocked("198.51.100.7:1"));
  EXPECT_THAT(budgets->TakeNewlyBlocked(), IsEmpty());
}

TEST_F(CallBudgetsTest, ZeroMeansNoLimit) {
  const auto budgets = Open(0.0);
  Begin(*budgets, 10 * kBurst, "192.0.2.1:1");
  EXPECT_FALSE(budgets->IsBlocked("192.0.2.1:1"));
}

TEST_F(CallBudgetsTest, ManyCallsThatWaitForTheirHandlersAreABacklog) {
  const auto budgets = Open();
  for (int i = 0; i < 4096; ++i) budgets->Receive();
  EXPECT_FALSE(budgets->HasBacklog());
  EXPECT_FALSE(Signals(*budgets));
  for (int i = 0; i < 512; ++i) budgets->Receive();
  EXPECT_TRUE(budgets->HasBacklog());
  EXPECT_TRUE(Signals(*budgets));
  budgets->TakeNewlyBlocked();
  EXPECT_FALSE(Signals(*budgets));
  for (int i = 0; i < 512; ++i) budgets->Receive();
  EXPECT_TRUE(Signals(*budgets)) << "again, while calls arrive";
  for (int i = 0; i < 1024; ++i) budgets->EndWaiting();
  EXPECT_FALSE(budgets->HasBacklog());
}

TEST_F(CallBudgetsTest, ANetworkCanBeBlockedForASecond) {
  const auto budgets = Open();
  budgets->Block("192.0.2.1:1");
  EXPECT_TRUE(budgets->IsBlocked("192.0.2.1:2"));
  EXPECT_FALSE(budgets->IsBlocked("192.0.2.2:1"));
  time_.Advance(std::chrono::seconds(1));
  EXPECT_FALSE(budgets->IsBlocked("192.0.2.1:2"));
}

}  // namespace
}  // namespace thunderhead::rpc_port
