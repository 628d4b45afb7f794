#include "base/memory_budget.h"

#include <deque>
#include <filesystem>
#include <fstream>
#include <future>
#include <limits>
#include <optional>
#include <thread>
#include <utility>

#include "base/error_details.h"
#include "base/guarded.h"
#include "base/machine_memory.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::base {
namespace {

using std::chrono::steady_clock;
using ::testing::HasSubstr;

constexpr std::size_t kMib = 1 << 20;

// A cache of memory reservations, each with the time of its last use.
class Kept final : public MemoryBudget::Cache {
 public:
  Kept(const std::shared_ptr<MemoryBudget>& budget, int first_s) : member_(budget, this) {
    for (int i = 0; i < 2; ++i) {
      entries_.emplace_back(steady_clock::time_point(std::chrono::seconds(first_s + 10 * i)),
                            budget->Reserve(MemoryUse::kFields, 10 * kMib, "kept").value());
    }
  }

  std::optional<steady_clock::time_point> OldestUnused() override {
    if (entries_.empty()) return std::nullopt;
    return entries_.front().first;
  }
  void DropOldestUnused() override { entries_.pop_front(); }
  std::size_t Left() const { return entries_.size(); }

 private:
  std::deque<std::pair<steady_clock::time_point, MemoryReservation>> entries_;
  const MemoryBudget::Member member_;
};

TEST(MemoryBudgetTest, CountsWhatIsHeldAndForgetsWhatIsGone) {
  const auto budget = MemoryBudget::Make({.bytes = 100 * kMib});
  {
    auto fields = budget->Reserve(MemoryUse::kFields, 30 * kMib, "fields").value();
    const auto moved = std::move(fields);
    const auto picture = budget->Reserve(MemoryUse::kPictures, 20 * kMib, "a picture").value();
    EXPECT_EQ(budget->Used(), 50 * kMib);
    EXPECT_EQ(budget->Used(MemoryUse::kPictures), 20 * kMib);
  }
  EXPECT_EQ(budget->Used(), 0U);
}

TEST(MemoryBudgetTest, RefusesByNameWithWhatTheMemoryIsUsedFor) {
  const auto budget = MemoryBudget::Make({.bytes = 100 * kMib});
  const auto fields = budget->Reserve(MemoryUse::kFields, 90 * kMib, "fields").value();
  const absl::Status refused =
      budget->Reserve(MemoryUse::kPictures, 20 * kMib, "a picture").status();
  EXPECT_TRUE(absl::IsResourceExhausted(refused)) << refused;
  EXPECT_THAT(std::string(refused.message()),
              HasSubstr("a picture needs 20 MiB of memory; 90 MiB of 100 MiB are in use: 90 MiB by "
                        "fields of storms"));
  const ErrorDetails details = DetailsOf(refused);
  EXPECT_EQ(details.reason, "MEMORY_BUDGET");
  EXPECT_TRUE(details.retry_after.has_value());
  EXPECT_EQ(budget->Refusals(), 1U);
  EXPECT_EQ(budget->Used(), 90 * kMib) << "a refusal takes nothing";
  EXPECT_FALSE(IsTooLargeForMemory(refused));
  EXPECT_TRUE(budget->HasRoom(10 * kMib));
  EXPECT_FALSE(budget->HasRoom(10 * kMib + 1));
  EXPECT_FALSE(budget->HasRoom(0, 0.5));
}

TEST(MemoryBudgetTest, WhatNeverFitsIsNotToBeTriedAgain) {
  const auto budget = MemoryBudget::Make({.bytes = 100 * kMib});
  const Kept kept(budget, 0);
  const absl::Status refused =
      budget->Reserve(MemoryUse::kFields, std::numeric_limits<std::size_t>::max(), "it").status();
  EXPECT_EQ(DetailsOf(refused).reason, "TOO_LARGE_FOR_MEMORY");
  EXPECT_TRUE(IsTooLargeForMemory(refused));
  EXPECT_FALSE(DetailsOf(refused).retry_after.has_value());
  EXPECT_TRUE(DetailsOf(refused).permanent);
  EXPECT_EQ(kept.Left(), 2U) << "nothing is dropped for it";
}

TEST(MemoryBudgetTest, CachesMakeRoomTheLeastRecentlyUsedFirst) {
  const auto budget = MemoryBudget::Make({.bytes = 40 * kMib});
  const Kept newer(budget, 5);  // its two entries were last used at 5 and 15 s
  const Kept older(budget, 0);  // its two entries were last used at 0 and 10 s
  const auto more = budget->Reserve(MemoryUse::kFields, 15 * kMib, "it");
  ASSERT_TRUE(more.ok()) << more.status();
  EXPECT_EQ(older.Left(), 1U);
  EXPECT_EQ(newer.Left(), 1U);
  EXPECT_FALSE(budget->Reserve(MemoryUse::kFields, 30 * kMib, "it").ok());
  EXPECT_EQ(older.Left() + newer.Left(), 0U);
}

TEST(MemoryBudgetTest, KeepsRoomForDrawing) {
  const auto budget = MemoryBudget::Make({.bytes = 100 * kMib, .kept_for_drawing = 40 * kMib});
  const auto fields = budget->Reserve(MemoryUse::kFields, 60 * kMib, "fields").value();
  EXPECT_FALSE(budget->Reserve(MemoryUse::kFields, 1, "more").ok());
  const auto drawing = budget->Reserve(MemoryUse::kDrawing, 40 * kMib, "drawing").value();
  EXPECT_FALSE(budget->Reserve(MemoryUse::kDrawing, 1, "drawing").ok());
}

TEST(MemoryBudgetTest, DrawingBeyondWhatIsKeptForItLeavesLessForFields) {
  const auto budget = MemoryBudget::Make({.bytes = 100 * kMib, .kept_for_drawing = 40 * kMib});
  const auto drawing = budget->Reserve(MemoryUse::kDrawing, 70 * kMib, "drawing").value();
  EXPECT_FALSE(budget->Reserve(MemoryUse::kFields, 31 * kMib, "fields").ok());
  EXPECT_TRUE(budget->Reserve(MemoryUse::kFields, 30 * kMib, "fields").ok());
}

TEST(MemoryBudgetTest, AReservationChangesItsSize) {
  const auto budget = MemoryBudget::Make({.bytes = 100 * kMib});
  auto held = budget->Reserve(MemoryUse::kFields, 50 * kMib, "it").value();
  ASSERT_TRUE(budget->Resize(held, 20 * kMib, "it").ok());
  EXPECT_EQ(budget->Used(), 20 * kMib);
  EXPECT_FALSE(budget->Resize(held, 101 * kMib, "it").ok());
  EXPECT_EQ(held.Bytes(), 20 * kMib);
  ASSERT_TRUE(budget->Resize(held, 100 * kMib, "it").ok());
  EXPECT_EQ(budget->Used(), 100 * kMib);
}

TEST(MemoryBudgetTest, WhoIsPatientGetsWhatOthersGiveBackWhenTheyAreAsked) {
  const auto budget = MemoryBudget::Make({.bytes = 100 * kMib});
  auto held = budget->Reserve(MemoryUse::kDrawing, 90 * kMib, "it").value();
  std::promise<void> pressed;
  budget->OnPressure([&] { pressed.set_value(); });
  std::thread owner([&] {
    pressed.get_future().wait();
    held = {};
    budget->Answer(budget->Refusals());
  });
  EXPECT_TRUE(
      budget->Reserve(MemoryUse::kFields, 50 * kMib, "it", MemoryBudget::Urgency::kPatient).ok());
  owner.join();
  budget->OnPressure({});
}

TEST(MemoryBudgetTest, ARefusalThrownIsWhatTheWorkReturns) {
  const auto budget = MemoryBudget::Make({.bytes = 1});
  const absl::Status refused = Guarded([&]() -> absl::Status {
    throw FailedAllocation(budget->Reserve(MemoryUse::kDrawing, 2, "it").status());
  });
  EXPECT_EQ(DetailsOf(refused).reason, "TOO_LARGE_FOR_MEMORY");
}

// A fixture with a folder that replaces the root folder of the file system.
class MachineMemoryTest : public ::testing::Test {
 protected:
  MachineMemoryTest() { Write("/proc/meminfo", "MemTotal:       16000000 kB\nMemFree:  1 kB\n"); }
  ~MachineMemoryTest() override { std::filesystem::remove_all(root_); }

  void Write(const std::string& path, const std::string& text) {
    std::filesystem::create_directories(std::filesystem::path(root_ + path).parent_path());
    std::ofstream(root_ + path) << text;
  }

  // The name contains the test's name, because tests run in parallel.
  const std::string root_ = ::testing::TempDir() + "machine_memory_" +
                            ::testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(MachineMemoryTest, IsTheMachines) {
  EXPECT_EQ(MachineMemoryBytes(root_), std::size_t{16000000} * 1024);
}

TEST_F(MachineMemoryTest, OrTheLeastOfTheGroupsAround) {
  Write("/proc/self/cgroup", "0::/system.slice/thunderhead.service\n");
  Write("/sys/fs/cgroup/system.slice/thunderhead.service/memory.max", "max\n");
  Write("/sys/fs/cgroup/system.slice/thunderhead.service/memory.high", "3000000000\n");
  Write("/sys/fs/cgroup/system.slice/memory.max", "2000000000\n");
  EXPECT_EQ(MachineMemoryBytes(root_), 2000000000U);
}

TEST_F(MachineMemoryTest, OrThatOfVersionOne) {
  Write("/proc/self/cgroup", "5:cpu,cpuacct:/\n4:memory:/docker/1a2b\n");
  Write("/sys/fs/cgroup/memory/docker/1a2b/memory.limit_in_bytes", "1073741824\n");
  EXPECT_EQ(MachineMemoryBytes(root_), 1073741824U);
}

}  // namespace
}  // namespace thunderhead::base
