// Tests of storms that are larger than the memory, and of storages that hang.
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <future>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/memory_budget.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "storm_store/storm_store.h"
#include "tests/support/manual_time.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wait_for.h"

namespace thunderhead::storm_store {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;
using testing::WaitFor;

constexpr int kManyTimes = 64;
constexpr int kCells = 64;
constexpr std::size_t kTimeBytes = std::size_t{kCells} * kCells * kCells * sizeof(float);

// A simulated storage whose responses a test can hold back.
class Storage {
 public:
  void Hang() {
    const std::lock_guard lock(mutex_);
    hangs_ = true;
  }
  void Answer() {
    {
      const std::lock_guard lock(mutex_);
      hangs_ = false;
    }
    changed_.notify_all();
  }
  void Pass() {
    std::unique_lock lock(mutex_);
    ++passed_;
    changed_.wait(lock, [this] { return !hangs_; });
  }
  int Passed() {
    const std::lock_guard lock(mutex_);
    return passed_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool hangs_ = false;
  int passed_ = 0;
};

constexpr std::uint64_t kFarDevice = 4711;

// A format whose file "cube" is one storm with many times, of cells in a cube. A file whose name
// begins with "far" comes from the storage, which is a separate device.
class CubeFormat final : public storm_files::StormFormat {
 public:
  explicit CubeFormat(std::shared_ptr<Storage> storage) : storage_(std::move(storage)) {}

  std::string_view Name() const override { return "a cube"; }
  std::string_view Example() const override { return "*.cube"; }
  std::string_view Requirement() const override { return "a cube"; }
  storm_files::FormatFit Sniff(const storm_files::UnknownFile& file) const override {
    return file.Path().ends_with(".cube") ? storm_files::FormatFit::kModelLayout
                                          : storm_files::FormatFit::kNone;
  }
  absl::StatusOr<storm_files::StormFile> Describe(
      const storm_files::UnknownFile& file) const override {
    storm_files::StormFile described;
    described.path = file.Path();
    std::ifstream(file.Path()) >> described.cells.x;
    described.cells = glm::ivec3(described.cells.x);
    described.dx_m = described.dy_m = 100.0;
    for (int i = 0; i < kManyTimes; ++i) described.times.push_back(absl::FromUnixSeconds(60 * i));
    described.fields = {physics::Hydrometeor::kRain};
    const bool far = file.Path().find("/far") != std::string::npos;
    if (far) described.device = kFarDevice;
    described.reader = std::make_shared<Reader>(far ? storage_ : nullptr, described.cells);
    return described;
  }

 private:
  class Reader final : public storm_files::RecordReader {
   public:
    Reader(std::shared_ptr<Storage> storage, const glm::ivec3& cells)
        : storage_(std::move(storage)), cells_(cells) {}

    absl::StatusOr<volume::HydrometeorFields> Read(
        const storm_files::RecordPart& /*part*/,
        const std::optional<storm_files::VerticalGrid>& /*grid*/,
        const storm_files::ReadCheckpoint& checkpoint) const override {
      if (storage_ != nullptr) storage_->Pass();
      if (absl::Status ended = checkpoint(0.5); !ended.ok()) return ended;
      volume::HydrometeorFields fields;
      fields.grid = {cells_, glm::dvec3(100.0), glm::dvec3(0.0)};
      volume::HydrometeorField rain;
      rain.hydrometeor = physics::Hydrometeor::kRain;
      rain.concentration_kg_per_m3.assign(fields.grid.CellCount(), 1e-3F);
      fields.fields.push_back(std::move(rain));
      return fields;
    }
    absl::StatusOr<storm_files::VerticalGrid> ReadVerticalGrid(
        std::size_t /*record*/) const override {
      return storm_files::VerticalGrid{0.0, 100.0, cells_.z};
    }

   private:
    const std::shared_ptr<Storage> storage_;
    const glm::ivec3 cells_;
  };

  const std::shared_ptr<Storage> storage_;
};

// A fixture whose time advances only where a test advances it.
class StormMemory : public ::testing::Test {
 protected:
  static constexpr milliseconds kDeadline{200};

  ~StormMemory() override { storage_->Answer(); }

  std::string Cube(const std::string& name, int cells) {
    const std::string path = folder_.File(name + ".cube");
    std::ofstream(path) << cells;
    return path;
  }

  std::unique_ptr<StormStore> Open(const std::vector<std::string>& paths,
                                   StormStoreOptions options) {
    options.formats.Add(std::make_shared<CubeFormat>(storage_));
    options.time = &time_;
    auto store = StormStore::Open(paths, options);
    EXPECT_TRUE(store.ok()) << store.status();
    return *std::move(store);
  }

  // Requests a time of "far.cube", whose storage hangs. Returns once it is being read.
  std::future<absl::Status> GetFar(StormStore& store, int time) {
    const int passed = storage_->Passed();
    auto far = std::async(std::launch::async,
                          [&store, time] { return store.Get("far.cube", time, {}).status(); });
    EXPECT_TRUE(WaitFor([&] { return storage_->Passed() > passed; }));
    return far;
  }

  testing::TemporaryFolder folder_;
  testing::ManualTime time_;
  const std::shared_ptr<Storage> storage_ = std::make_shared<Storage>();
};

TEST_F(StormMemory, SixtyFourTimesThatAreHeldKeepWithinTheBudget) {
  const auto budget = base::MemoryBudget::Make({.bytes = 24 * kTimeBytes});
  const auto store = Open({Cube("storm", kCells)}, {.memory = budget, .read_ahead = 1});
  std::vector<std::shared_ptr<const volume::HydrometeorFields>> held;
  int refused = 0;
  for (int time = 0; time < kManyTimes; ++time) {
    auto fields = store->Get("storm.cube", time, {});
    EXPECT_LE(budget->Used(), budget->Bytes());
    if (fields.ok()) {
      held.push_back(*std::move(fields));
      continue;
    }
    ++refused;
    EXPECT_EQ(base::DetailsOf(fields.status()).reason, "MEMORY_BUDGET") << fields.status();
    EXPECT_TRUE(base::DetailsOf(fields.status()).retry_after.has_value());
    EXPECT_THAT(std::string(fields.status().message()), HasSubstr("storm 'storm.cube'"));
  }
  // Reading needs additional memory, so not every time that fits can be read.
  EXPECT_GE(held.size(), 8U);
  EXPECT_EQ(held.size() + static_cast<std::size_t>(refused), std::size_t{kManyTimes});
  EXPECT_GE(budget->Used(base::MemoryUse::kFields), held.size() * kTimeBytes);
  EXPECT_EQ(budget->Used(base::MemoryUse::kReading), 0U);
  // Times that are no longer held can be evicted for others.
  held.clear();
  EXPECT_TRUE(store->Get("storm.cube", kManyTimes - 1, {}).ok());
  EXPECT_LE(budget->Used(), budget->Bytes());
}

TEST_F(StormMemory, WhatNobodyHoldsGoesFirst) {
  const auto budget = base::MemoryBudget::Make({.bytes = 24 * kTimeBytes});
  const auto store = Open({Cube("storm", kCells)}, {.memory = budget, .read_ahead = 0});
  const auto held = store->Get("storm.cube", 0, {}).value();
  for (int time = 1; time < kManyTimes; ++time) {
    ASSERT_TRUE(store->Get("storm.cube", time, {}).ok()) << time;
    EXPECT_LE(budget->Used(), budget->Bytes());
  }
  EXPECT_EQ(store->Peek("storm.cube", 0), held)
      << "what is held is not dropped: that frees nothing";
  EXPECT_EQ(store->Peek("storm.cube", 1), nullptr);
  EXPECT_NE(store->Peek("storm.cube", kManyTimes - 1), nullptr);
}

TEST_F(StormMemory, CellsWhoseNumberOverflowsAreRefusedBeforeAnythingIsAllocated) {
  StormStoreOptions options;
  options.formats.Add(std::make_shared<CubeFormat>(storage_));
  const absl::Status refused = StormStore::Open({Cube("huge", 2'000'000'000)}, options).status();
  EXPECT_TRUE(absl::IsResourceExhausted(refused)) << refused;
  EXPECT_THAT(std::string(refused.message()),
              HasSubstr("has 2000000000 x 2000000000 x 2000000000 values"));
  EXPECT_TRUE(base::DetailsOf(refused).permanent);
}

TEST_F(StormMemory, ATimeBeyondTheBudgetIsRefusedBeforeItIsRead) {
  // The fields of one time need 64 MB, which is more than the budget.
  const auto budget = base::MemoryBudget::Make({.bytes = std::size_t{32} << 20U});
  const auto store = Open({Cube("large", 250)}, {.memory = budget, .read_ahead = 0});
  const absl::Status refused = store->Get("large.cube", 0, {}).status();
  EXPECT_EQ(base::DetailsOf(refused).reason, "TOO_LARGE_FOR_MEMORY") << refused;
  EXPECT_FALSE(base::DetailsOf(refused).retry_after.has_value());
}

TEST_F(StormMemory, AStorageThatHangsIsNamedAndHoldsUpNothingThatIsInMemory) {
  const auto store = Open({Cube("far", kCells), Cube("near", kCells)},
                          {.read_ahead = 1, .read_deadline = kDeadline});
  ASSERT_TRUE(store->Get("near.cube", 0, {}).ok());
  storage_->Hang();
  auto far = GetFar(*store, 0);
  time_.Advance(kDeadline);
  EXPECT_FALSE(store->Hung().has_value());
  time_.Advance(milliseconds(1));
  const absl::Status late = far.get();
  EXPECT_TRUE(absl::IsDeadlineExceeded(late)) << late;
  EXPECT_THAT(std::string(late.message()), HasSubstr("far.cube"));
  EXPECT_EQ(base::DetailsOf(late).reason, "STORAGE_HANGS");
  EXPECT_TRUE(base::DetailsOf(late).retry_after.has_value());
  ASSERT_TRUE(store->Hung().has_value());
  EXPECT_THAT(store->Hung()->file, HasSubstr("far.cube"));
  // Times in memory are still returned. A read of the same storage is refused at once, while time
  // stands still.
  EXPECT_TRUE(store->Get("near.cube", 0, {}).ok());
  EXPECT_EQ(store->Storms().size(), 2U);
  EXPECT_TRUE(absl::IsDeadlineExceeded(store->Get("far.cube", 9, {}).status()));
  // The storage must respond before the store is destroyed. Otherwise the store would wait for its
  // reading thread, and no time passes.
  storage_->Answer();
}

TEST_F(StormMemory, AStorageThatHangsLeavesOthersToAnotherThread) {
  std::filesystem::create_directories(folder_.Path() / "other");
  const auto store = Open({Cube("far", kCells), Cube("other/farther", kCells), Cube("b", kCells)},
                          {.read_ahead = 0, .read_deadline = kDeadline});
  ASSERT_TRUE(store->Get("b.cube", 0, {}).ok());
  storage_->Hang();
  auto far = GetFar(*store, 0);
  // Two more reads wait behind the hanging read: one from another storage, and one from the same
  // storage.
  auto behind =
      std::async(std::launch::async, [&] { return store->Get("b.cube", 1, {}).status(); });
  auto behind_it =
      std::async(std::launch::async, [&] { return store->Get("far.cube", 1, {}).status(); });
  ASSERT_TRUE(WaitFor([&] { return store->PendingReads() == 3; }));
  time_.Advance(kDeadline + milliseconds(1));
  EXPECT_TRUE(absl::IsDeadlineExceeded(far.get()));
  EXPECT_TRUE(absl::IsDeadlineExceeded(behind_it.get()));
  EXPECT_TRUE(behind.get().ok());
  // The storage is now known to hang, so other reads begin at once, although no time passes.
  double progress = 0.0;
  EXPECT_TRUE(store->Get("b.cube", 2, [&](double share) { progress = share; }).ok());
  EXPECT_EQ(progress, 0.5);
  // No other file is read from the hanging storage, whichever folder the file is in.
  const int before = storage_->Passed();
  EXPECT_TRUE(absl::IsDeadlineExceeded(store->Get("farther.cube", 0, {}).status()));
  EXPECT_TRUE(absl::IsDeadlineExceeded(store->Get("far.cube", 1, {}).status()));
  EXPECT_EQ(storage_->Passed(), before);
  storage_->Answer();
  EXPECT_TRUE(store->Get("b.cube", 2, {}).ok());
  EXPECT_TRUE(WaitFor([&] { return store->Get("far.cube", 0, {}).ok(); }));
}

// A slow read that has made some progress does not count as hanging.
TEST_F(StormMemory, AReadThatTakesLongLeavesOtherFilesToAnotherThread) {
  const auto store = Open({Cube("far", kCells), Cube("far2", kCells)}, {.read_ahead = 0});
  storage_->Hang();
  auto far = GetFar(*store, 0);
  std::vector<std::future<absl::Status>> behind;
  for (const char* name : {"far.cube", "far2.cube"}) {
    behind.push_back(std::async(std::launch::async,
                                [&store, name] { return store->Get(name, 1, {}).status(); }));
  }
  ASSERT_TRUE(WaitFor([&] { return store->PendingReads() == 3; }));
  EXPECT_EQ(storage_->Passed(), 1);
  time_.Advance(std::chrono::seconds(5));
  // The read of the other file begins. The reads of the same file continue to wait.
  ASSERT_TRUE(WaitFor([&] { return storage_->Passed() == 2; }));
  EXPECT_EQ(behind[0].wait_for(milliseconds(0)), std::future_status::timeout);
  EXPECT_FALSE(store->Hung().has_value());
  storage_->Answer();
  EXPECT_TRUE(far.get().ok());
  for (auto& read : behind) EXPECT_TRUE(read.get().ok());
}

// However many of its files are requested, a hanging storage does not occupy the last thread.
TEST_F(StormMemory, AStorageThatHangsDoesNotTakeTheLastThread) {
  std::vector<std::string> paths{Cube("near", kCells)};
  for (int i = 0; i < 6; ++i) paths.push_back(Cube(absl::StrCat("far", i), kCells));
  const auto store = Open(paths, {.read_ahead = 0});
  storage_->Hang();
  std::vector<std::future<absl::Status>> far;
  for (int i = 0; i < 6; ++i) {
    far.push_back(std::async(std::launch::async, [&store, i] {
      return store->Get(absl::StrCat("far", i, ".cube"), 0, {}).status();
    }));
  }
  ASSERT_TRUE(WaitFor([&] { return store->PendingReads() == 6 && storage_->Passed() == 1; }));
  for (int begun = 2; begun <= 3; ++begun) {
    time_.Advance(std::chrono::seconds(5));
    ASSERT_TRUE(WaitFor([&] { return storage_->Passed() == begun; }));
  }
  time_.Advance(std::chrono::seconds(5));
  EXPECT_TRUE(store->Get("near.cube", 0, {}).ok());
  EXPECT_EQ(storage_->Passed(), 3);
  time_.Advance(std::chrono::seconds(60));
  for (auto& read : far) EXPECT_TRUE(absl::IsDeadlineExceeded(read.get()));
  storage_->Answer();
}

TEST_F(StormMemory, PlaybackGoesOnBesideAStorageThatHangs) {
  const auto store = Open({Cube("far", kCells), Cube("near", kCells)},
                          {.read_ahead = 1, .read_deadline = kDeadline});
  ASSERT_TRUE(store->Get("near.cube", 0, {}).ok());
  ASSERT_TRUE(WaitFor([&] { return store->Peek("near.cube", 1) != nullptr; }));
  storage_->Hang();
  auto hung = GetFar(*store, 0);
  ASSERT_TRUE(WaitFor([&] { return storage_->Passed() == 1; }));
  time_.Advance(kDeadline + milliseconds(1));
  EXPECT_TRUE(absl::IsDeadlineExceeded(hung.get()));
  // The storage is known to hang, so these calls return at once, although no time passes.
  for (int time = 1; time < 8; ++time) {
    EXPECT_TRUE(store->Get("near.cube", time, {}).ok()) << time;
  }
  storage_->Answer();
}

TEST_F(StormMemory, AStorageThatAnswersAgainGivesWhatWasAskedFor) {
  const auto store = Open({Cube("far", kCells)}, {.read_ahead = 0, .read_deadline = kDeadline});
  storage_->Hang();
  auto far = GetFar(*store, 0);
  time_.Advance(kDeadline + milliseconds(1));
  ASSERT_TRUE(absl::IsDeadlineExceeded(far.get()));
  storage_->Answer();
  EXPECT_TRUE(WaitFor([&] { return store->Get("far.cube", 0, {}).ok(); }));
  EXPECT_FALSE(store->Hung().has_value());
  EXPECT_EQ(storage_->Passed(), 1) << "what was read late is kept";
}

TEST_F(StormMemory, AReadThatGoesOnSlowlyIsNotRefused) {
  const auto store = Open({Cube("near", kCells)}, {.read_ahead = 0, .read_deadline = kDeadline});
  // Several reads wait behind one another, together for longer than the deadline.
  std::vector<std::jthread> callers;
  std::atomic<int> given = 0;
  for (int time = 0; time < 6; ++time) {
    callers.emplace_back([&, time] {
      const auto fields =
          store->Get("near.cube", time, [this](double) { time_.Advance(kDeadline / 3); });
      if (fields.ok()) ++given;
    });
  }
  callers.clear();
  EXPECT_EQ(given, 6);
}

TEST_F(StormMemory, AStoreEndsWhileItsStorageHangs) {
  auto store = Open({Cube("far", kCells)}, {.read_ahead = 1, .read_deadline = kDeadline});
  storage_->Hang();
  auto far = GetFar(*store, 0);
  time_.Advance(kDeadline + milliseconds(1));
  ASSERT_FALSE(far.get().ok());
  auto ended = std::async(std::launch::async, [&] { store.reset(); });
  EXPECT_TRUE(WaitFor([&] {
    time_.Advance(milliseconds(100));
    return ended.wait_for(milliseconds(0)) == std::future_status::ready;
  }));
  storage_->Answer();
  EXPECT_TRUE(WaitFor([&] { return storage_.use_count() == 1; }))
      << "its thread finds what it used, and ends";
}

}  // namespace
}  // namespace thunderhead::storm_store
