#include "storm_store/storm_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <thread>

#include "absl/strings/str_format.h"
#include "storm_files/storm_format.h"
#include "storm_store/fields_cache.h"
#include "tests/support/synthetic_wrf.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wait_for.h"

namespace thunderhead::storm_store {
namespace {

using testing::SyntheticWrf;
using testing::TemporaryFolder;
using testing::WaitFor;
using testing::WrfCell;

constexpr int kTimes = 6;

// A fixture with a series of six files, one time each. The cloud of time t has 1e-3 * (t + 1)
// kg/kg. The layers' heights vary by some metres from time to time.
class StormSeries : public ::testing::Test {
 protected:
  StormSeries() {
    const std::string series = folder_.File("series");
    std::filesystem::create_directory(series);
    for (int time = 0; time < kTimes; ++time) {
      SyntheticWrf file;
      file.nx = 24;
      file.ny = 20;
      file.times = {absl::StrFormat("2013-05-20_%02d:00:00", time)};
      file.interface_height_m = [time](const WrfCell& cell) {
        return cell.level * (500.0 + 0.5 * (time % 3));
      };
      file.mixing_ratios["QCLOUD"] = [time](const WrfCell& cell) {
        return cell.level == 4 ? 1e-3 * (time + 1) : 0.0;
      };
      testing::WriteWrf(file, absl::StrFormat("%s/wrfout_d01_%02d:00:00", series, time));
    }
    one_time_ = Open({.read_ahead = 0})->Get("series", 0, {}).value()->Bytes();
  }

  std::unique_ptr<StormStore> Open(const StormStoreOptions& options) {
    auto store = StormStore::Open({folder_.File("series")}, options);
    EXPECT_TRUE(store.ok()) << store.status();
    return *std::move(store);
  }

  // Waits until that time has been read ahead and no later time is read. The reading thread begins
  // the next time before others see the one that it has read.
  static bool ReadsAheadNoFurtherThan(StormStore& store, int time) {
    return WaitFor(
        [&] { return store.Peek("series", time) != nullptr && store.PendingReads() == 0; });
  }

  TemporaryFolder folder_;
  std::size_t one_time_ = 0;
};

TEST_F(StormSeries, GivesEachTimeItsFieldsOnOneGrid) {
  const auto store = Open({.read_ahead = 0});
  const volume::RegularGrid grid = store->Get("series", 0, {}).value()->grid;
  for (int time = 0; time < kTimes; ++time) {
    const auto fields = store->Get("series", time, {});
    ASSERT_TRUE(fields.ok()) << fields.status();
    EXPECT_NEAR((*fields)->fields[0].statistics.maximum, 1e-3 * (time + 1), 1e-8);
    EXPECT_EQ((*fields)->grid, grid);
  }
}

TEST_F(StormSeries, GivesATimeTheSameGridWhateverWasReadBefore) {
  const auto fields = Open({.read_ahead = 0})->Get("series", 2, {});
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ((*fields)->grid, Open({.read_ahead = 0})->Get("series", 0, {}).value()->grid);
}

TEST_F(StormSeries, NamesWhatIsNotThere) {
  const auto store = Open({});
  const auto unknown = store->Get("tornado", 0, {});
  EXPECT_EQ(unknown.status().code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(std::string(unknown.status().message()), ::testing::HasSubstr("series"));
  EXPECT_EQ(store->Get("series", kTimes, {}).status().code(), absl::StatusCode::kOutOfRange);
  EXPECT_EQ(store->Get("series", -1, {}).status().code(), absl::StatusCode::kOutOfRange);
  EXPECT_EQ(store->Find("tornado"), nullptr);
  EXPECT_EQ(store->Peek("tornado", 0), nullptr);
  EXPECT_EQ(store->Find("series"), store->Storms()[0]);
}

TEST_F(StormSeries, TakesAnotherStormWhileItServes) {
  const auto store = Open({});
  StormInfoPtr series = store->Find("series");
  const std::string other = folder_.File("another.nc");
  std::filesystem::copy_file(series->files[0], other);
  const auto added = store->Add(other);
  ASSERT_TRUE(added.ok()) << added.status();
  EXPECT_EQ((*added)->id, "another");
  EXPECT_EQ(store->Find("series"), series) << "what is pointed to stays";
  EXPECT_EQ(store->Storms(), (std::vector<StormInfoPtr>{series, *added}));
  EXPECT_TRUE(store->Get("another", 0, {}).ok());
  EXPECT_EQ(store->Add(other).status().code(), absl::StatusCode::kAlreadyExists);
  EXPECT_FALSE(store->Add(folder_.File("nothing.nc")).ok());
}

TEST_F(StormSeries, ForgetsAStormThatIsRemoved) {
  const auto store = Open({.read_ahead = 2});
  const auto held = store->Get("series", 0, {});
  ASSERT_TRUE(held.ok()) << held.status();
  StormInfoPtr info = store->Find("series");
  ASSERT_TRUE(store->Remove("series").ok());
  EXPECT_THAT(store->Storms(), ::testing::IsEmpty());
  EXPECT_EQ(store->Find("series"), nullptr);
  EXPECT_TRUE(absl::IsNotFound(store->Get("series", 0, {}).status()));
  EXPECT_EQ(store->Peek("series", 0), nullptr);
  EXPECT_TRUE(absl::IsNotFound(store->Remove("series")));
  EXPECT_EQ(info->id, "series") << "what was pointed to stays";
  EXPECT_GT((*held)->Bytes(), 0U) << "and what was given";
  EXPECT_TRUE(WaitFor([&] { return store->CachedBytes() == 0; }));
  // Another storm of that name may be added.
  ASSERT_TRUE(store->Add(folder_.File("series")).ok());
  EXPECT_TRUE(store->Get("series", 1, {}).ok());
}

TEST_F(StormSeries, TellsWhichTimesAreInMemory) {
  const auto store = Open({.read_ahead = 2});
  EXPECT_THAT(store->TimesInMemory("series"), ::testing::IsEmpty());
  ASSERT_TRUE(store->Get("series", 1, {}).ok());
  EXPECT_TRUE(WaitFor([&] { return store->TimesInMemory("series") == std::vector{1, 2, 3}; }));
  EXPECT_THAT(store->TimesInMemory("another"), ::testing::IsEmpty());
  ASSERT_TRUE(store->Remove("series").ok());
  EXPECT_THAT(store->TimesInMemory("series"), ::testing::IsEmpty());
}

TEST_F(StormSeries, ReadsATimeOnceWhileItIsHeld) {
  const auto store = Open({.read_ahead = 0});
  EXPECT_EQ(store->Peek("series", 3), nullptr);
  const auto first = store->Get("series", 3, {});
  ASSERT_TRUE(first.ok()) << first.status();
  EXPECT_EQ(store->Get("series", 3, {}).value(), *first);
  EXPECT_EQ(store->Peek("series", 3), *first);
  EXPECT_EQ(store->CachedBytes(), (*first)->Bytes());
}

TEST_F(StormSeries, LetsTheLeastRecentlyUsedGo) {
  const auto store = Open({.byte_budget = 3 * one_time_, .read_ahead = 0});
  for (const int time : {0, 1, 2}) ASSERT_TRUE(store->Get("series", time, {}).ok());
  ASSERT_TRUE(store->Get("series", 0, {}).ok());  // time 1 is now the least recently used
  ASSERT_TRUE(store->Get("series", 3, {}).ok());
  EXPECT_EQ(store->Peek("series", 1), nullptr);
  for (const int time : {0, 2, 3}) EXPECT_NE(store->Peek("series", time), nullptr) << time;
  EXPECT_EQ(store->CachedBytes(), 3 * one_time_);
}

TEST_F(StormSeries, KeepsTheNewestEvenIfItAloneIsTooLarge) {
  const auto store = Open({.byte_budget = 1, .read_ahead = 2});
  ASSERT_TRUE(store->Get("series", 0, {}).ok());
  EXPECT_NE(store->Peek("series", 0), nullptr);
  const auto second = store->Get("series", 1, {});
  ASSERT_TRUE(second.ok()) << second.status();
  EXPECT_EQ(store->Peek("series", 0), nullptr);
  EXPECT_EQ(store->CachedBytes(), one_time_);
  // Evicting a time that a caller holds would free nothing.
  ASSERT_TRUE(store->Get("series", 2, {}).ok());
  EXPECT_EQ(store->Peek("series", 1), *second);
}

TEST_F(StormSeries, ReadsTheNextTimesAhead) {
  const auto store = Open({.read_ahead = 2});
  ASSERT_TRUE(store->Get("series", 1, {}).ok());
  EXPECT_TRUE(ReadsAheadNoFurtherThan(*store, 3));
  EXPECT_NE(store->Peek("series", 2), nullptr);
  EXPECT_EQ(store->Peek("series", 4), nullptr);
  EXPECT_EQ(store->Peek("series", 0), nullptr);
}

TEST_F(StormSeries, StopsReadingAheadAtTheLastTime) {
  const auto store = Open({.read_ahead = 3});
  ASSERT_TRUE(store->Get("series", kTimes - 2, {}).ok());
  EXPECT_TRUE(WaitFor([&] { return store->Peek("series", kTimes - 1) != nullptr; }));
  ASSERT_TRUE(store->Get("series", kTimes - 1, {}).ok());
  EXPECT_EQ(store->CachedBytes(), 2 * one_time_);
}

TEST_F(StormSeries, NeverPushesOutTheTimeInViewByReadingAhead) {
  const auto store = Open({.byte_budget = 2 * one_time_, .read_ahead = 4});
  ASSERT_TRUE(store->Get("series", 0, {}).ok());
  EXPECT_TRUE(ReadsAheadNoFurtherThan(*store, 1));
  EXPECT_NE(store->Peek("series", 0), nullptr);
  EXPECT_NE(store->Peek("series", 1), nullptr);
  EXPECT_LE(store->CachedBytes(), 2 * one_time_);
}

// A reader that counts the ends of its reads.
class CountingReader final : public storm_files::RecordReader {
 public:
  CountingReader(std::shared_ptr<const storm_files::RecordReader> reader, std::atomic<int>& ended)
      : reader_(std::move(reader)), ended_(ended) {}

  absl::StatusOr<volume::HydrometeorFields> Read(
      const storm_files::RecordPart& part, const std::optional<storm_files::VerticalGrid>& grid,
      const storm_files::ReadCheckpoint& checkpoint) const override {
    auto fields = reader_->Read(part, grid, checkpoint);
    ++ended_;
    return fields;
  }
  absl::StatusOr<storm_files::VerticalGrid> ReadVerticalGrid(std::size_t record) const override {
    return reader_->ReadVerticalGrid(record);
  }

 private:
  std::shared_ptr<const storm_files::RecordReader> reader_;
  std::atomic<int>& ended_;
};

// The next time is larger than the one in view, because only it has a cloud.
TEST_F(StormSeries, DropsATimeThatWasReadAheadAndDoesNotFit) {
  SyntheticWrf file;
  file.nx = 24;
  file.ny = 20;
  file.times = {"2013-05-20_00:00:00", "2013-05-20_01:00:00"};
  file.mixing_ratios["QCLOUD"] = [](const WrfCell& cell) { return cell.record * 1e-3; };
  const std::string path = folder_.File("wrfout_growing");
  testing::WriteWrf(file, path);
  std::atomic<int> ended{0};
  StormStoreOptions options = {.read_ahead = 0};
  options.formats.LeaveTo(
      {.describe =
           [&ended](const std::string& described) -> absl::StatusOr<storm_files::StormFile> {
        auto found = storm_files::StormFormats::BuiltIn().Describe(described);
        if (found.ok()) found->reader = std::make_shared<CountingReader>(found->reader, ended);
        return found;
      }});
  const auto in_view = StormStore::Open({path}, options).value();
  const std::string id = in_view->Storms()[0]->id;
  const std::size_t small = in_view->Get(id, 0, {}).value()->Bytes();
  const std::size_t large = in_view->Get(id, 1, {}).value()->Bytes();
  ASSERT_GT(large, 2 * small);
  options.byte_budget = 2 * small;
  options.read_ahead = 1;
  ended = 0;
  const auto store = StormStore::Open({path}, options).value();
  ASSERT_TRUE(store->Get(id, 0, {}).ok());
  ASSERT_TRUE(WaitFor([&] { return ended == 2 && store->PendingReads() == 0; }));
  EXPECT_EQ(store->CachedBytes(), small);
  EXPECT_NE(store->Peek(id, 0), nullptr);
}

// A broken next time harms neither the time in view nor the read-ahead thread.
TEST_F(StormSeries, OutlivesABrokenTimeWhenReadingAhead) {
  const auto store = Open({.read_ahead = 2});
  const std::string broken = store->Storms()[0]->files[1];
  std::filesystem::resize_file(broken, 1000);
  ASSERT_TRUE(store->Get("series", 0, {}).ok());
  EXPECT_TRUE(WaitFor([&] { return store->Peek("series", 2) != nullptr; }));
  const auto second = store->Get("series", 1, {});
  EXPECT_EQ(second.status().code(), absl::StatusCode::kDataLoss);
  EXPECT_THAT(std::string(second.status().message()), ::testing::HasSubstr(broken));
}

TEST_F(StormSeries, ReadsOnceForAllWhoAskAtTheSameTime) {
  const auto store = Open({.read_ahead = 0});
  constexpr int kThreads = 8;
  std::vector<std::shared_ptr<const volume::HydrometeorFields>> got(kThreads);
  std::atomic<int> ready = 0;
  std::vector<std::thread> threads;
  threads.reserve(kThreads);
  for (int i = 0; i < kThreads; ++i) {
    threads.emplace_back([&, i] {
      ++ready;
      while (ready < kThreads) std::this_thread::yield();
      const auto fields = store->Get("series", 2, {});
      if (fields.ok()) got[i] = *fields;
    });
  }
  for (std::thread& thread : threads) thread.join();
  ASSERT_NE(got[0], nullptr);
  EXPECT_THAT(got, ::testing::Each(got[0]));
  EXPECT_EQ(store->CachedBytes(), one_time_);
}

TEST_F(StormSeries, ServesManyThreadsThatWanderAboutWithinABudget) {
  const auto store = Open({.byte_budget = 3 * one_time_, .read_ahead = 2});
  std::atomic<int> failures = 0;
  constexpr int kThreads = 4;
  std::vector<std::thread> threads;
  threads.reserve(kThreads);
  for (int i = 0; i < kThreads; ++i) {
    threads.emplace_back([&, i] {
      for (int step = 0; step < 25; ++step) {
        const int time = (i * 5 + step * (i + 1)) % kTimes;
        const auto fields = store->Get("series", time, {});
        const bool right = fields.ok() && std::abs((*fields)->fields[0].statistics.maximum -
                                                   1e-3F * static_cast<float>(time + 1)) < 1e-7F;
        failures += right ? 0 : 1;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(failures, 0);
  // Times in use are kept beyond the budget until another time is read.
  ASSERT_TRUE(WaitFor([&] { return store->PendingReads() == 0; }));
  int time = 0;
  while (store->Peek("series", time) != nullptr) ++time;
  ASSERT_TRUE(store->Get("series", time, {}).ok());
  EXPECT_LE(store->CachedBytes(), 3 * one_time_);
}

TEST_F(StormSeries, EndsWhileItReadsAhead) {
  for (int i = 0; i < 20; ++i) {
    const auto store = Open({.read_ahead = 5});
    ASSERT_TRUE(store->Get("series", 0, {}).ok());
    // In each round the store is destroyed at a different stage of its reading.
    const auto read = static_cast<std::size_t>(i % kTimes);
    ASSERT_TRUE(WaitFor([&] { return store->TimesInMemory("series").size() >= read; }));
  }
}

std::shared_ptr<const volume::HydrometeorFields> FieldsOf(std::size_t values) {
  volume::HydrometeorFields fields;
  fields.terrain_height_m.resize(values);
  return std::make_shared<const volume::HydrometeorFields>(std::move(fields));
}

TEST(FieldsCache, PutsWhatIsReadAheadBehindTheNewest) {
  FieldsCache cache(3 * 40);
  cache.Insert({0, 0}, FieldsOf(10));
  cache.Insert({0, 1}, FieldsOf(10));
  cache.InsertAhead({0, 2}, FieldsOf(10));
  cache.InsertAhead({0, 3}, FieldsOf(10));
  EXPECT_FALSE(cache.Holds({0, 0})) << "the oldest goes first";
  EXPECT_TRUE(cache.Holds({0, 1})) << "the newest stays";
  EXPECT_TRUE(cache.Holds({0, 2}));
  EXPECT_TRUE(cache.Holds({0, 3}));
  EXPECT_EQ(cache.Bytes(), 120U);
}

TEST(FieldsCache, CountsATimeThatIsPutInTwiceOnce) {
  FieldsCache cache(1000);
  cache.Insert({0, 0}, FieldsOf(10));
  cache.Insert({0, 0}, FieldsOf(20));
  EXPECT_EQ(cache.Bytes(), 80U);
  EXPECT_EQ(cache.NewestBytes(), 80U);
}

}  // namespace
}  // namespace thunderhead::storm_store
