// Tests that the catalogue follows changes in its folders. Some tests scan the folders at given
// times, others use a store that gets the kernel's file events.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <future>
#include <iterator>
#include <mutex>

#include "absl/strings/str_format.h"
#include "base/error_details.h"
#include "netcdf/netcdf_lock.h"
#include "storm_store/catalogue_scan.h"
#include "storm_store/storm_ids.h"
#include "storm_store/storm_store.h"
#include "tests/support/captured_log.h"
#include "tests/support/manual_time.h"
#include "tests/support/synthetic_wrf.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wait_for.h"

namespace thunderhead::storm_store {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::SyntheticWrf;
using testing::TemporaryFolder;
using testing::WrfCell;

std::string Bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Writes the file in place, so that its inode stays the same.
void Put(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

class LiveFolder : public ::testing::Test {
 protected:
  LiveFolder() {
    fs::create_directory(data_);
    fs::create_directory(elsewhere_);
  }

  // Returns the bytes of a file with the times of these hours, whose cloud water has the mixing
  // ratio `cloud`.
  std::string WrfBytes(const std::vector<int>& hours, double cloud = 1e-3) {
    SyntheticWrf file;
    file.microphysics = 2;  // a scheme whose QCLOUD is liquid
    file.top_m = top_m_;
    for (file.times.clear(); const int hour : hours) {
      file.times.push_back(absl::StrFormat("2013-05-20_%02d:00:00", hour));
    }
    file.mixing_ratios["QCLOUD"] = [cloud](const WrfCell& cell) {
      return cell.level == 4 ? cloud : 0.0;
    };
    const std::string path = elsewhere_ + "/written";
    const netcdf::NetcdfLock lock;  // a catalogue may be reading meanwhile
    testing::WriteWrf(file, path);
    return Bytes(path);
  }

  std::string File(int hour) const {
    return absl::StrFormat("%s/wrfout_d01_%02d:00:00", data_, hour);
  }

  void PutOld(const std::string& path, const std::string& bytes) {
    Put(path, bytes);
    fs::last_write_time(path, fs::file_time_type::clock::now() - std::chrono::hours(1));
  }

  // Writes the file elsewhere and moves it into place, so that it becomes visible in one step.
  void MoveInto(const std::string& path, const std::string& bytes) {
    Put(elsewhere_ + "/complete", bytes);
    fs::rename(elsewhere_ + "/complete", path);
  }

  CatalogueScan Scanner(seconds settle = seconds(3)) {
    return CatalogueScan({.paths = {data_},
                          .formats = storm_files::StormFormats::BuiltIn(),
                          .settle = settle,
                          .retry = seconds(30)});
  }

  // Scans at the time `after` and returns the numbers of times of the storms found.
  std::vector<std::size_t> TimesAt(CatalogueScan& scan, seconds after) {
    const auto result = scan.Scan(CatalogueScan::Time(std::chrono::hours(1)) + after);
    EXPECT_TRUE(result.ok()) << result.status();
    std::vector<std::size_t> times;
    for (const CataloguedStorm& storm : result->storms) times.push_back(storm.info.times.size());
    return times;
  }

  std::unique_ptr<StormStore> Open(milliseconds rescan = std::chrono::hours(1)) {
    StormStoreOptions options;
    options.read_ahead = 0;
    options.live = LiveCatalogueOptions{.rescan = rescan, .settle = milliseconds(200)};
    options.time = &time_;
    auto store = StormStore::Open({data_}, options);
    EXPECT_TRUE(store.ok()) << store.status();
    return *std::move(store);
  }

  // Advances the stores' clock until `condition()` is true. At all other times the clock stands
  // still. The test never advances it by an hour, the usual pause between scans.
  template <typename Condition>
  bool Eventually(Condition condition) {
    return testing::WaitFor([&] {
      if (condition()) return true;
      time_.Advance(milliseconds(10));
      return false;
    });
  }

  static std::size_t TimesOf(const StormStore& store) {
    std::size_t times = 0;
    for (const StormInfoPtr& storm : store.Storms()) times += storm->times.size();
    return times;
  }

  testing::ManualTime time_;
  TemporaryFolder folder_;
  double top_m_ = SyntheticWrf().top_m;
  const std::string data_ = folder_.File("series");
  const std::string elsewhere_ = folder_.File("elsewhere");
};

// One of two folders hangs. Changes in the other folder are still found, and the storms of the
// hanging folder remain in the catalogue.
TEST_F(LiveFolder, AFolderThatHangsHoldsUpNoOther) {
  const std::string other = folder_.File("other");
  fs::create_directories(other);
  PutOld(File(0), WrfBytes({0}));
  PutOld(other + "/wrfout_d01_00:00:00", WrfBytes({0}));
  std::promise<void> storage;
  const auto hangs = std::make_shared<std::atomic<bool>>(false);
  const auto begun = std::make_shared<std::atomic<int>>(0);
  CatalogueScan scan({.paths = {data_, other},
                      .formats = storm_files::StormFormats::BuiltIn(),
                      .settle = seconds(3),
                      .retry = seconds(30),
                      .look_at =
                          [hangs, begun, answers = storage.get_future().share(),
                           gone = data_](const std::string& path) {
                            if (!*hangs || path != gone) return;
                            ++*begun;
                            answers.wait();
                          },
                      .patience = milliseconds(100),
                      .time = &time_});
  EXPECT_THAT(TimesAt(scan, seconds(0)), ElementsAre(1, 1));
  *hangs = true;
  PutOld(other + "/wrfout_d01_01:00:00", WrfBytes({1}));
  fs::remove(File(0));  // the scan cannot detect this
  auto waiting = std::async(std::launch::async, [&] { return TimesAt(scan, seconds(10)); });
  ASSERT_TRUE(testing::WaitFor([&] { return *begun == 1; }));
  time_.Advance(milliseconds(100));
  EXPECT_THAT(waiting.get(), ElementsAre(1, 1));
  // The hang is known, so no scan waits for the folder while time stands still.
  EXPECT_THAT(TimesAt(scan, seconds(20)), ElementsAre(1, 2));
  storage.set_value();
  EXPECT_TRUE(testing::WaitFor([&] { return TimesAt(scan, seconds(30)).size() == 1; }));
}

TEST_F(LiveFolder, OffersAFileThatComesInPiecesWhenItIsComplete) {
  const std::string whole = WrfBytes({0});
  CatalogueScan scan = Scanner();
  EXPECT_THAT(TimesAt(scan, seconds(0)), ElementsAre());
  Put(File(0), whole.substr(0, whole.size() / 2));
  EXPECT_THAT(TimesAt(scan, seconds(1)), ElementsAre());
  EXPECT_THAT(TimesAt(scan, seconds(10)), ElementsAre()) << "it rests, but it is truncated";
  Put(File(0), whole);
  EXPECT_THAT(TimesAt(scan, seconds(11)), ElementsAre()) << "it has just changed";
  EXPECT_THAT(TimesAt(scan, seconds(13)), ElementsAre());
  EXPECT_THAT(TimesAt(scan, seconds(14)), ElementsAre(1));
}

TEST_F(LiveFolder, DoesNotOfferAFileWhoseSizeMoves) {
  const std::string whole = WrfBytes({0});
  CatalogueScan scan = Scanner();
  TimesAt(scan, seconds(0));
  // The file is readable at any time, but it changes again before it has been unchanged for long
  // enough.
  for (int second = 1; second < 20; second += 2) {
    Put(File(0), whole + std::string(static_cast<std::size_t>(second), '\0'));
    EXPECT_THAT(TimesAt(scan, seconds(second)), ElementsAre()) << second;
  }
}

TEST_F(LiveFolder, OffersOldFilesAtOnceAndNewOnesLater) {
  PutOld(File(0), WrfBytes({0}));
  Put(File(1), WrfBytes({1}));
  CatalogueScan scan = Scanner(minutes(30));
  EXPECT_THAT(TimesAt(scan, seconds(0)), ElementsAre(1));
  EXPECT_THAT(TimesAt(scan, minutes(30)), ElementsAre(2)) << "one series of both";
}

// One of these files alone would be a storm with its own name.
TEST_F(LiveFolder, FilesOfOneFolderThatAreGivenOneByOneAreAllOffered) {
  std::vector<std::string> files;
  for (const int hour : {18, 19, 20}) {
    files.push_back(File(hour));
    PutOld(files.back(), WrfBytes({hour}));
  }
  CatalogueScan scan(
      {.paths = files, .formats = storm_files::StormFormats::BuiltIn(), .retry = seconds(30)});
  EXPECT_THAT(TimesAt(scan, seconds(0)), ElementsAre(1, 1, 1));
}

TEST_F(LiveFolder, FilesThatCameJustBeforeTheStartAreOfferedTogether) {
  for (int hour = 0; hour < 2; ++hour) {
    Put(File(hour), WrfBytes({hour}));
    fs::last_write_time(File(hour), fs::file_time_type::clock::now() - minutes(20 * hour));
  }
  CatalogueScan scan = Scanner(minutes(40));
  EXPECT_THAT(TimesAt(scan, seconds(0)), ElementsAre());
  EXPECT_THAT(TimesAt(scan, minutes(20)), ElementsAre());
  EXPECT_THAT(TimesAt(scan, minutes(40)), ElementsAre(2));
}

TEST_F(LiveFolder, KeepsTheTimesOfAFileThatGrows) {
  const std::string one = WrfBytes({0});
  const std::string two = WrfBytes({0, 1});
  ASSERT_GT(two.size(), one.size());
  PutOld(File(0), one);
  CatalogueScan scan = Scanner();
  EXPECT_THAT(TimesAt(scan, seconds(0)), ElementsAre(1));
  Put(File(0), two.substr(0, two.size() - 100));
  EXPECT_THAT(TimesAt(scan, seconds(1)), ElementsAre(1));
  EXPECT_THAT(TimesAt(scan, seconds(5)), ElementsAre(1)) << "not readable now";
  Put(File(0), two);
  EXPECT_THAT(TimesAt(scan, seconds(6)), ElementsAre(1));
  EXPECT_THAT(TimesAt(scan, seconds(9)), ElementsAre(2));
}

TEST_F(LiveFolder, AFileThatShrinksIsAnother) {
  const std::string whole = WrfBytes({0});
  PutOld(File(0), whole);
  CatalogueScan scan = Scanner();
  EXPECT_THAT(TimesAt(scan, seconds(0)), ElementsAre(1));
  Put(File(0), whole.substr(0, 1000));
  EXPECT_THAT(TimesAt(scan, seconds(1)), ElementsAre());
}

TEST_F(LiveFolder, OpensAFileOnlyWhenItHasChanged) {
  PutOld(File(0), WrfBytes({0}));
  PutOld(data_ + "/README", "no storm");
  int opened = 0;
  storm_files::StormFormats formats = storm_files::StormFormats::BuiltIn();
  formats.LeaveTo({.describe = [&opened](const std::string& path) {
    ++opened;
    return storm_files::StormFormats::BuiltIn().Describe(path);
  }});
  CatalogueScan scan(
      {.paths = {data_}, .formats = formats, .settle = seconds(3), .retry = seconds(30)});
  TimesAt(scan, seconds(0));
  EXPECT_EQ(opened, 2);
  TimesAt(scan, seconds(10));
  TimesAt(scan, seconds(20));
  EXPECT_EQ(opened, 2);
  TimesAt(scan, seconds(31));
  EXPECT_EQ(opened, 3) << "what could not be read is tried again";
}

TEST_F(LiveFolder, AScanThatIsStoppedOpensNoOtherBatchOfFiles) {
  for (int hour = 0; hour < 3; ++hour) {
    // A large file is a batch alone.
    std::string bytes = WrfBytes({hour});
    bytes.resize(9 << 20);
    PutOld(File(hour), bytes);
  }
  int opened = 0;
  std::function<void()> stop;
  CatalogueScan scan({.paths = {data_},
                      .formats = storm_files::StormFormats::BuiltIn(),
                      .settle = seconds(3),
                      .retry = seconds(30),
                      .before_file = [&] {
                        ++opened;
                        stop();
                      }});
  stop = [&scan] { scan.Stop(); };
  const auto result = scan.Scan(CatalogueScan::Time(std::chrono::hours(1)));
  EXPECT_EQ(result.status().code(), absl::StatusCode::kCancelled);
  EXPECT_EQ(opened, 1);
}

TEST_F(LiveFolder, AFolderThatGoesAwayComesBack) {
  PutOld(File(0), WrfBytes({0}));
  const auto store = Open(milliseconds(100));
  ASSERT_EQ(TimesOf(*store), 1U);
  fs::rename(data_, folder_.File("away"));
  Put(data_, "a file in the folder's place");
  EXPECT_TRUE(Eventually([&] { return TimesOf(*store) == 0; }))
      << "a path that is gone is no storm";
  fs::remove(data_);
  fs::rename(folder_.File("away"), data_);
  EXPECT_TRUE(Eventually([&] { return TimesOf(*store) == 1; }));
}

TEST_F(LiveFolder, AnEmptyFolderIsWaitedFor) {
  const auto store = Open();
  EXPECT_TRUE(store->Storms().empty());
  MoveInto(File(0), WrfBytes({0}));
  EXPECT_TRUE(Eventually([&] { return TimesOf(*store) == 1; }));
  // The scan at the start is over, so only the kernel's event reports this file.
  MoveInto(File(1), WrfBytes({1}));
  EXPECT_TRUE(Eventually([&] { return TimesOf(*store) == 2; }));
}

TEST_F(LiveFolder, ASearchThatTakesLongDoesNotHoldUpTheStart) {
  PutOld(File(0), WrfBytes({0}));
  std::promise<void> may_go_on;
  const std::shared_future<void> goes_on = may_go_on.get_future();
  StormStoreOptions options;
  options.read_ahead = 0;
  options.live = LiveCatalogueOptions{.first_search = milliseconds(0)};
  options.time = &time_;
  options.formats.LeaveTo({.describe = [goes_on](const std::string& path) {
    goes_on.wait();
    return storm_files::StormFormats::BuiltIn().Describe(path);
  }});
  const auto store = StormStore::Open({data_}, options);
  ASSERT_TRUE(store.ok()) << store.status();
  EXPECT_TRUE((*store)->IsSearching());
  EXPECT_TRUE((*store)->Storms().empty());
  may_go_on.set_value();
  EXPECT_TRUE(testing::WaitFor([&] { return !(*store)->IsSearching(); }));
  EXPECT_EQ((*store)->Storms().size(), 1U);
}

TEST_F(LiveFolder, APathThatIsNotThereIsAnError) {
  StormStoreOptions options;
  options.live = LiveCatalogueOptions{};
  EXPECT_FALSE(StormStore::Open({folder_.File("typing-error")}, options).ok());
}

TEST_F(LiveFolder, TwelveFilesCopiedOneByOneAreOneSeriesThatGrows) {
  std::mutex mutex;
  std::vector<std::pair<std::string, std::size_t>> told;
  const auto store = Open();
  store->Listen([&](const CatalogueChange& change) {
    const std::lock_guard lock(mutex);
    for (const StormChange& storm : change) {
      ASSERT_NE(storm.after, nullptr);
      told.emplace_back(storm.after->id, storm.after->times.size());
    }
  });
  for (int hour = 0; hour < 12; ++hour) {
    const std::string whole = WrfBytes({hour});
    std::ofstream copy(File(hour), std::ios::binary);
    for (std::size_t at = 0; at < whole.size(); at += whole.size() / 4) {
      copy << whole.substr(at, whole.size() / 4) << std::flush;
      time_.Advance(milliseconds(20));
      EXPECT_EQ(TimesOf(*store), static_cast<std::size_t>(hour));
    }
    copy.close();
    ASSERT_TRUE(Eventually([&] { return TimesOf(*store) == static_cast<std::size_t>(hour) + 1; }))
        << hour;
  }
  ASSERT_EQ(store->Storms().size(), 1U);
  EXPECT_EQ(store->Storms()[0]->id, "series");
  store->Listen({});
  ASSERT_EQ(told.size(), 12U);
  EXPECT_EQ(told[0], std::pair(std::string("wrfout_d01_00-00-00"), std::size_t{1}));
  EXPECT_EQ(told[11], std::pair(std::string("series"), std::size_t{12}));
}

// A newcomer whose folder is before that of the known storm must not get its id.
TEST_F(LiveFolder, AKnownStormKeepsItsIdWhenAnotherFileHasItsName) {
  for (const char* folder : {"/a", "/b", "/z"}) fs::create_directory(data_ + folder);
  PutOld(data_ + "/z/run.nc", WrfBytes({0}));
  const auto store = Open(milliseconds(100));
  ASSERT_EQ(TimesOf(*store), 1U);
  for (const char* folder : {"/a", "/b"}) {
    const std::size_t before = TimesOf(*store);
    MoveInto(data_ + folder + "/run.nc", WrfBytes({5}));
    ASSERT_TRUE(Eventually([&] { return TimesOf(*store) == before + 1; }));
    ASSERT_NE(store->Find("run"), nullptr);
    EXPECT_THAT(store->Find("run")->files, ElementsAre(data_ + "/z/run.nc"));
  }
  std::vector<std::string> ids;
  for (const StormInfoPtr& storm : store->Storms()) ids.push_back(storm->id);
  EXPECT_THAT(ids, ElementsAre("run", "run-2", "run-3"));
  EXPECT_THAT(store->Find("run-2")->files, ElementsAre(data_ + "/a/run.nc"));
}

// The id of a storm that became a series stays its own, although the series has another id.
TEST_F(LiveFolder, ANewStormDoesNotGetAnIdThatAnotherStormHad) {
  for (const char* folder : {"/a", "/z"}) fs::create_directory(data_ + folder);
  PutOld(data_ + "/z/run.nc", WrfBytes({0}));
  const auto store = Open(milliseconds(100));
  MoveInto(data_ + "/z/more.nc", WrfBytes({1}));
  ASSERT_TRUE(Eventually([&] { return store->Find("z") != nullptr; }));
  MoveInto(data_ + "/a/run.nc", WrfBytes({5}));
  ASSERT_TRUE(Eventually([&] { return store->Storms().size() == 2; }));
  EXPECT_EQ(store->Find("run"), nullptr);
  fs::remove(data_ + "/z/more.nc");
  ASSERT_TRUE(Eventually([&] { return store->Find("run") != nullptr; }));
  EXPECT_THAT(store->Find("run")->files, ElementsAre(data_ + "/z/run.nc"));
}

// The server restarts, and meanwhile a file of the same name was put before the known one.
TEST_F(LiveFolder, AStormKeepsItsIdAcrossARestart) {
  for (const char* folder : {"/a", "/z"}) fs::create_directory(data_ + folder);
  PutOld(data_ + "/z/run.nc", WrfBytes({0}));
  const auto files_of_run = [this](std::string& ids) {
    StormStoreOptions options;
    options.read_ahead = 0;
    options.live = LiveCatalogueOptions{
        .ids = ids, .keep_ids = [&ids](const std::string& kept) { ids = kept; }};
    options.time = &time_;
    const auto store = StormStore::Open({data_}, options);
    EXPECT_TRUE(store.ok()) << store.status();
    return (*store)->Find("run")->files;
  };
  std::string kept;
  EXPECT_THAT(files_of_run(kept), ElementsAre(data_ + "/z/run.nc"));
  PutOld(data_ + "/a/run.nc", WrfBytes({5}));
  EXPECT_THAT(files_of_run(kept), ElementsAre(data_ + "/z/run.nc"));
  // The storm is away for one run of the server.
  fs::rename(data_ + "/z", data_ + "/.z");
  fs::rename(data_ + "/a/run.nc", data_ + "/a/other.nc");
  PutOld(data_ + "/run.nc", WrfBytes({7}));
  std::string without;
  EXPECT_THAT(files_of_run(without), ElementsAre(data_ + "/run.nc"));
  EXPECT_THAT(files_of_run(kept), ElementsAre(data_ + "/run.nc")) << "the id is free";
  fs::rename(data_ + "/.z", data_ + "/z");
  EXPECT_THAT(files_of_run(kept), ElementsAre(data_ + "/run.nc")) << "it belongs to this one now";
}

TEST(StormIds, TextThatIsCutShortOrForgedGivesNoWrongId) {
  CataloguedStorm storm;
  storm.stem = "run";
  storm.info.files = {"/d/a\nb", "/d/c"};
  StormIds ids;
  ids.Set(storm, "run-2");
  const std::string text = ids.ToText();
  EXPECT_EQ(StormIds(text), ids);
  EXPECT_EQ(StormIds(text).Of(storm), "run-2");
  EXPECT_EQ(StormIds(text.substr(0, 9)).Of(storm), std::nullopt);
  for (const char* id : {"other", "run-", "run-x", "runs"}) {
    StormIds forged;
    forged.Set(storm, id);
    EXPECT_EQ(StormIds(forged.ToText()).Of(storm), std::nullopt) << id;
  }
}

TEST_F(LiveFolder, ANewSubfolderIsWatchedToo) {
  PutOld(File(0), WrfBytes({0}));
  const auto store = Open();
  fs::create_directory(data_ + "/run2");
  MoveInto(data_ + "/run2/wrfout_d01_05:00:00", WrfBytes({5}));
  EXPECT_TRUE(Eventually([&] { return TimesOf(*store) == 2; }));
  MoveInto(data_ + "/run2/wrfout_d01_06:00:00", WrfBytes({6}));
  EXPECT_TRUE(Eventually([&] { return TimesOf(*store) == 3; }));
}

TEST_F(LiveFolder, KeepsWhatIsCachedWhileTimesComeAndGo) {
  PutOld(File(1), WrfBytes({1}, 1e-3));
  PutOld(File(2), WrfBytes({2}, 2e-3));
  const auto store = Open();
  const auto shown = store->Get("series", 1, {});
  ASSERT_TRUE(shown.ok());
  MoveInto(File(0), WrfBytes({0}, 5e-3));
  ASSERT_TRUE(Eventually([&] { return TimesOf(*store) == 3; }));
  EXPECT_EQ(store->Peek("series", 2), *shown) << "its index has moved";
  EXPECT_EQ(store->Peek("series", 1), nullptr);
  EXPECT_DOUBLE_EQ(store->Find("series")->times[2].elapsed_s, 7200.0);
}

TEST_F(LiveFolder, ADeletedTimeStaysWhileItIsLookedAt) {
  for (int hour = 0; hour < 3; ++hour) PutOld(File(hour), WrfBytes({hour}));
  const auto store = Open(milliseconds(100));
  auto shown = store->Get("series", 1, {});
  ASSERT_TRUE(shown.ok());
  fs::remove(File(0));
  fs::remove(File(1));
  ASSERT_TRUE(Eventually([&] { return TimesOf(*store) == 2; })) << "nobody looks at the first";
  const StormInfoPtr storm = store->Storms()[0];
  EXPECT_TRUE(storm->times[0].deleted);
  EXPECT_FALSE(storm->times[1].deleted);
  EXPECT_EQ(*store->Get(storm->id, 0, {}), *shown);
  shown = absl::NotFoundError("");
  EXPECT_TRUE(Eventually([&] { return TimesOf(*store) == 1; }));
}

TEST_F(LiveFolder, AFileThatReplacesTheOneInViewIsRead) {
  PutOld(File(0), WrfBytes({0}, 1e-3));
  const auto store = Open(milliseconds(100));
  const std::string id = store->Storms()[0]->id;
  const auto shown = store->Get(id, 0, {});
  ASSERT_TRUE(shown.ok());
  MoveInto(File(0), WrfBytes({5}, 2e-3));
  ASSERT_TRUE(Eventually([&] { return TimesOf(*store) == 2; })) << "the old time is in view";
  EXPECT_TRUE(store->Storms()[0]->times[0].deleted);
  const auto next = store->Get(id, 1, {});
  ASSERT_TRUE(next.ok()) << next.status();
  EXPECT_FLOAT_EQ((*next)->fields[0].statistics.maximum, 2e-3F);
}

TEST_F(LiveFolder, OfTwoFilesWithOneTimeTheOneWrittenLastIsUsed) {
  PutOld(File(1), WrfBytes({0, 1}, 1e-3));
  Put(File(0), WrfBytes({1, 2}, 2e-3));  // an earlier name, but written later
  const testing::CapturedLog log;
  const auto found = FindStorms({data_}, storm_files::StormFormats::BuiltIn());
  ASSERT_TRUE(found.ok()) << found.status();
  ASSERT_EQ(found->size(), 1U);
  const CataloguedStorm& storm = found->front();
  ASSERT_EQ(storm.info.times.size(), 3U);
  EXPECT_EQ(storm.info.times[1].file, File(0));
  EXPECT_THAT(log.Text(), HasSubstr("the latter is used, because it was written later"));
  EXPECT_THAT(storm.info.assumptions,
              ElementsAre("2013-05-20T01:00:00Z is in wrfout_d01_01:00:00 and in "
                          "wrfout_d01_00:00:00; the latter is used, because it was written later"));
}

TEST_F(LiveFolder, ATimeThatAFileHasTwiceIsReported) {
  PutOld(File(0), WrfBytes({0, 1, 1}));
  const auto found = FindStorms({data_}, storm_files::StormFormats::BuiltIn());
  ASSERT_TRUE(found.ok()) << found.status();
  const CataloguedStorm& storm = found->front();
  ASSERT_EQ(storm.info.times.size(), 2U);
  EXPECT_EQ(storm.sources[1].record, 2U);
  EXPECT_THAT(storm.info.assumptions, ElementsAre(HasSubstr("in records 1 and 2")));
}

TEST_F(LiveFolder, AFieldThatOneFileLacksLeavesTheSeriesWhole) {
  for (const int hour : {0, 1, 2}) PutOld(File(hour), WrfBytes({hour}));
  SyntheticWrf other;
  other.microphysics = 2;
  other.top_m = top_m_;
  other.times = {"2013-05-20_01:00:00"};
  for (const char* name : {"QCLOUD", "QRAIN"}) {
    other.mixing_ratios[name] = [](const WrfCell&) { return 1e-3; };
  }
  testing::WriteWrf(other, File(1));
  fs::last_write_time(File(1), fs::file_time_type::clock::now() - std::chrono::hours(1));
  const auto found = FindStorms({data_}, storm_files::StormFormats::BuiltIn());
  ASSERT_TRUE(found.ok()) << found.status();
  ASSERT_EQ(found->size(), 1U);
  EXPECT_EQ(found->front().info.times.size(), 3U);
  EXPECT_THAT(found->front().info.fields,
              ElementsAre(physics::Hydrometeor::kCloud, physics::Hydrometeor::kRain));
  EXPECT_THAT(found->front().info.assumptions, ElementsAre(HasSubstr("1 more files have no rain")));
}

TEST_F(LiveFolder, ADeletedStormStaysWhileItIsLookedAt) {
  PutOld(File(0), WrfBytes({0}));
  const auto store = Open(milliseconds(100));
  const std::string id = store->Storms()[0]->id;
  auto shown = store->Get(id, 0, {});
  ASSERT_TRUE(shown.ok());
  fs::remove(File(0));
  ASSERT_TRUE(Eventually([&] { return store->Find(id)->times[0].deleted; }));
  EXPECT_EQ(*store->Get(id, 0, {}), *shown);
  shown = absl::NotFoundError("");
  EXPECT_TRUE(Eventually([&] { return store->Storms().empty(); }));
  EXPECT_EQ(store->Get(id, 0, {}).status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(store->CachedBytes(), 0U);
}

TEST_F(LiveFolder, AFileThatIsReplacedKeepsItsTimesUntilTheOtherIsRead) {
  PutOld(File(0), WrfBytes({0, 1}));
  CatalogueScan scan = Scanner();
  EXPECT_THAT(TimesAt(scan, seconds(0)), ElementsAre(2));
  MoveInto(File(0), WrfBytes({1, 2, 3}));
  EXPECT_THAT(TimesAt(scan, seconds(1)), ElementsAre(2));
  MoveInto(File(0), WrfBytes({2, 3, 4}));
  EXPECT_THAT(TimesAt(scan, seconds(3)), ElementsAre(2)) << "replaced once more";
  EXPECT_THAT(TimesAt(scan, seconds(6)), ElementsAre(3));
  MoveInto(File(0), "no storm");
  EXPECT_THAT(TimesAt(scan, seconds(7)), ElementsAre(3));
  EXPECT_THAT(TimesAt(scan, seconds(10)), ElementsAre());
}

// The test writes the file in place, so the file is visible before it is complete.
TEST_F(LiveFolder, AFileThatIsWrittenInTheOthersPlaceHasNoTimesUntilItIsComplete) {
  PutOld(File(0), WrfBytes({0}));
  CatalogueScan scan = Scanner();
  EXPECT_THAT(TimesAt(scan, seconds(0)), ElementsAre(1));
  const std::string whole = WrfBytes({0});
  MoveInto(File(0), whole.substr(0, whole.size() / 2));
  EXPECT_THAT(TimesAt(scan, seconds(1)), ElementsAre(1)) << "it may be whole";
  Put(File(0), whole);
  EXPECT_THAT(TimesAt(scan, seconds(2)), ElementsAre());
  EXPECT_THAT(TimesAt(scan, seconds(5)), ElementsAre(1));
}

TEST_F(LiveFolder, NothingIsReadOfAFileThatIsNotTheOneDescribed) {
  PutOld(File(0), WrfBytes({0}, 1e-3));
  PutOld(File(1), WrfBytes({1}, 2e-3));
  StormStoreOptions options;
  options.read_ahead = 0;
  options.live = LiveCatalogueOptions{.rescan = std::chrono::hours(1), .settle = seconds(5)};
  options.time = &time_;
  const auto store = *StormStore::Open({data_}, options);
  const auto shown = store->Get("series", 0, {});
  ASSERT_TRUE(shown.ok());
  MoveInto(File(0), WrfBytes({0}, 4e-3));
  MoveInto(File(1), WrfBytes({1}, 4e-3));
  EXPECT_EQ(*store->Get("series", 0, {}), *shown) << "it is in memory";
  const auto refused = store->Get("series", 1, {});
  EXPECT_EQ(refused.status().code(), absl::StatusCode::kUnavailable) << refused.status();
  EXPECT_TRUE(base::DetailsOf(refused.status()).retry_after.has_value());
  EXPECT_EQ(TimesOf(*store), 2);
  EXPECT_TRUE(Eventually([&] {
    EXPECT_EQ(TimesOf(*store), 2) << "at any time";
    const auto fields = store->Get("series", 1, {});
    return fields.ok() && (*fields)->fields[0].statistics.maximum > 3e-3;
  }));
}

// WRF overwrites its output in this way when it is started again. The inode stays the same, and the
// size may stay the same.
TEST_F(LiveFolder, AFileThatIsWrittenAnewIsReadAgain) {
  PutOld(File(0), WrfBytes({0}, 1e-3));
  const auto store = Open();
  const std::string id = store->Storms()[0]->id;
  const auto shown = store->Get(id, 0, {});
  ASSERT_TRUE(shown.ok());
  const std::uint64_t version = store->Find(id)->times[0].version;
  Put(File(0), WrfBytes({0}, 4e-3));
  EXPECT_TRUE(Eventually([&] {
    const auto fields = store->Get(id, 0, {});
    return fields.ok() && (*fields)->fields[0].statistics.maximum > 3e-3;
  }));
  EXPECT_NE(store->Find(id)->times[0].version, version);
}

TEST_F(LiveFolder, AnotherRunMayHaveOtherLevels) {
  PutOld(File(0), WrfBytes({0, 1}));
  const auto store = Open();
  const std::string id = store->Storms()[0]->id;
  const auto before = store->Get(id, 1, {});
  ASSERT_TRUE(before.ok()) << before.status();
  top_m_ *= 3.0;
  MoveInto(File(0), WrfBytes({0, 1}));
  EXPECT_TRUE(Eventually([&] {
    const auto after = store->Get(id, 1, {});
    return after.ok() && (*after)->grid.spacing_m.z > 2.0 * (*before)->grid.spacing_m.z;
  }));
}

TEST_F(LiveFolder, AFileThatIsReplacedIsReadAgain) {
  PutOld(File(0), WrfBytes({0}, 1e-3));
  const auto store = Open();
  const std::string id = store->Storms()[0]->id;
  const auto shown = store->Get(id, 0, {});  // holding it keeps it in memory
  ASSERT_TRUE(shown.ok());
  EXPECT_NEAR((*shown)->fields[0].statistics.maximum, 1e-3, 1e-8);
  MoveInto(File(0), WrfBytes({0}, 4e-3));
  EXPECT_TRUE(Eventually([&] {
    const auto fields = store->Get(id, 0, {});
    return fields.ok() && (*fields)->fields[0].statistics.maximum > 3e-3;
  }));
}

}  // namespace
}  // namespace thunderhead::storm_store
