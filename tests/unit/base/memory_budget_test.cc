#include "base/memory_budget.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "base/error_details.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::base {
namespace {

using ::testing::HasSubstr;

constexpr std::size_t kMib = 1 << 20;

class MemoryBudgetTest : public ::testing::Test {
 protected:
  const std::shared_ptr<MemoryBudget> budget_ =
      std::make_shared<MemoryBudget>(100 * kMib, "--memory");
};

TEST_F(MemoryBudgetTest, WhatIsGivenBackIsFreeAgain) {
  {
    const auto first = budget_->Reserve(60 * kMib, "a");
    ASSERT_TRUE(first.ok());
    EXPECT_EQ(budget_->UsedBytes(), 60 * kMib);
    EXPECT_FALSE(budget_->Reserve(41 * kMib, "b").ok());
    EXPECT_EQ(budget_->UsedBytes(), 60 * kMib) << "a refusal takes nothing";
    EXPECT_TRUE(budget_->Reserve(40 * kMib, "b").ok());
  }
  EXPECT_EQ(budget_->UsedBytes(), 0U);
  EXPECT_TRUE(budget_->Reserve(100 * kMib, "c").ok());
}

TEST_F(MemoryBudgetTest, RefusalsSayWhatForHowMuchAndWhatToDo) {
  const auto held = budget_->Reserve(75 * kMib, "a");
  const absl::Status later = budget_->Reserve(50 * kMib, "time 3 of storm anvil").status();
  EXPECT_TRUE(absl::IsResourceExhausted(later));
  EXPECT_EQ(later.message(),
            "time 3 of storm anvil needs 50 MiB of memory; of the 100 MiB that the server may use "
            "25 are free: try again later");
  EXPECT_EQ(DetailsOf(later).reason, "OUT_OF_MEMORY");
  EXPECT_TRUE(DetailsOf(later).retry_after.has_value());
  const absl::Status never = budget_->Reserve(200 * kMib, "it").status();
  EXPECT_THAT(std::string(never.message()), HasSubstr("its operator may raise --memory"));
  EXPECT_FALSE(DetailsOf(never).retry_after.has_value());
}

TEST_F(MemoryBudgetTest, EstimatesAreCorrectedBeyondTheBudgetIfNeedBe) {
  auto held = budget_->Reserve(50 * kMib, "a");
  held->Correct(120 * kMib);
  EXPECT_EQ(budget_->UsedBytes(), 120 * kMib);
  EXPECT_FALSE(budget_->Reserve(1, "b").ok());
  held->Correct(10 * kMib);
  EXPECT_EQ(budget_->UsedBytes(), 10 * kMib);
}

TEST_F(MemoryBudgetTest, MovedReservationsAreGivenBackOnce) {
  auto held = std::make_optional(*budget_->Reserve(50 * kMib, "a"));
  MemoryBudget::Reservation moved = std::move(*held);
  held.reset();
  EXPECT_EQ(budget_->UsedBytes(), 50 * kMib);
  moved = MemoryBudget::Reservation();
  EXPECT_EQ(budget_->UsedBytes(), 0U);
}

TEST_F(MemoryBudgetTest, TheDefaultIsAPartOfTheMachines) {
  EXPECT_GT(DefaultMemoryBudgetBytes(), 64 * kMib);
}

}  // namespace
}  // namespace thunderhead::base
