// Tests that files of one folder, however many or slow, do not keep the storms of other folders
// from the list.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "storm_store/assembled_storm.h"
#include "storm_store/catalogue_scan.h"
#include "storm_store/fair_folders.h"
#include "storm_store/folder_walk.h"
#include "storm_store/left_out_log.h"
#include "storm_store/renewed_storms.h"
#include "tests/support/captured_log.h"
#include "tests/support/manual_time.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::storm_store {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;
using storm_files::StormFile;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// Returns the description of a file with one time.
StormFile Described(const std::string& path) {
  StormFile file;
  file.path = path;
  file.cells = {2, 2, 2};
  file.dx_m = file.dy_m = 1000.0;
  file.times = {absl::UnixEpoch()};
  file.fields = {physics::Hydrometeor::kRain};
  file.run = path;
  return file;
}

class HostileFolders : public ::testing::Test {
 protected:
  std::string Write(const std::string& name, const std::string& text = "storm") {
    const fs::path path = data_ / name;
    fs::create_directories(path.parent_path());
    std::ofstream(path) << text;
    fs::last_write_time(path, fs::file_time_type::clock::now() - std::chrono::hours(1));
    return path.string();
  }

  // Describes files by their names, and takes the time that a confined reader would take.
  storm_files::StormFormats Formats() {
    storm_files::StormFormats formats = storm_files::StormFormats::BuiltIn();
    formats.LeaveTo(
        {.describe = [this](const std::string& path) { return DescribeOne(path, minutes(1)); },
         .describe_each =
             [this](const std::vector<std::string>& paths, milliseconds patience) {
               std::vector<absl::StatusOr<StormFile>> files;
               const bool is_slow = std::ranges::any_of(paths, IsSlow);
               for (const std::string& path : paths) {
                 if (is_slow && paths.size() > 1) {
                   files.emplace_back(absl::AbortedError("describe it alone"));
                 } else {
                   files.push_back(DescribeOne(path, patience));
                 }
               }
               if (is_slow && paths.size() > 1) time_.Advance(patience);
               return files;
             },
         .describe_together =
             [this](const std::vector<std::string>& paths) -> absl::StatusOr<StormFile> {
           ++together_;
           time_.Advance(seconds(1));
           StormFile file = Described(paths.front());
           file.parts = paths;
           return file;
         }});
    return formats;
  }

  static bool IsSlow(const std::string& path) { return absl::StrContains(path, "slow"); }

  absl::StatusOr<StormFile> DescribeOne(const std::string& path, milliseconds patience) {
    ++described_;
    if (IsSlow(path)) {
      time_.Advance(patience);
      if (patience < minutes(1)) return absl::AbortedError("needs longer");
      return absl::DeadlineExceededError(absl::StrCat(path, ": its reader was ended"));
    }
    if (absl::StrContains(path, "notes")) {
      return absl::InvalidArgumentError(absl::StrCat(path, ": is no storm"));
    }
    time_.Advance(milliseconds(20));
    StormFile file = Described(path);
    if (!absl::StrContains(path, "part")) return file;
    // "part-0-3-5" is a part of the times 0, 3 and 5.
    file.part.of = fs::path(path).parent_path().string();
    file.times.clear();
    const std::vector<std::string> words = absl::StrSplit(fs::path(path).filename().string(), '-');
    for (const std::string& word : words) {
      int minute = 0;
      if (absl::SimpleAtoi(word, &minute)) {
        file.times.push_back(absl::UnixEpoch() + absl::Minutes(minute));
      }
    }
    return file;
  }

  CatalogueScan Scanner(std::size_t most_entries = 200'000) {
    return CatalogueScan({.paths = {data_.string()},
                          .formats = Formats(),
                          .settle = seconds(3),
                          .retry = seconds(30),
                          .most_entries = most_entries,
                          .time = &time_});
  }

  CatalogueScan::Result Scan(CatalogueScan& scan) {
    auto result = scan.Scan(time_.Now());
    EXPECT_TRUE(result.ok()) << result.status();
    return result.ok() ? *std::move(result) : CatalogueScan::Result();
  }

  static std::vector<std::string> Ids(const CatalogueScan::Result& result) {
    std::vector<std::string> ids;
    for (const CataloguedStorm& storm : result.storms) ids.push_back(storm.info.id);
    return ids;
  }

  // Lists at most `most` entries. Returns the paths of the files below the data folder.
  std::vector<std::string> List(std::size_t most, const std::vector<std::string>& known = {}) {
    reports_.clear();
    const LinkRules links = LinkRulesOf({data_.string()}, {});
    const auto listed = ListFolders(
        data_.string(),
        {.links = links,
         .on_left_out = [this](const std::string&,
                               const absl::Status& why) { reports_.emplace_back(why.message()); },
         .known_below = [&](const std::string&) { return known; },
         .most_entries = most});
    EXPECT_TRUE(listed.ok()) << listed.status();
    std::vector<std::string> files;
    for (const ListedFolder& folder : *listed) {
      for (const std::string& file : folder.files) {
        files.push_back(fs::path(file).lexically_relative(data_).string());
      }
    }
    return files;
  }

  testing::TemporaryFolder folder_;
  const fs::path data_ = folder_.Path() / "data";
  testing::ManualTime time_;
  int described_ = 0;
  int together_ = 0;
  std::vector<std::string> reports_;
};

TEST_F(HostileFolders, AFolderOfManyFilesLeavesOthersTheirShare) {
  // A folder is read in steps of 4000 entries.
  for (int i = 0; i < 6000; ++i) Write(absl::StrCat("a/", i));
  Write("z/deep/er/victim");
  EXPECT_THAT(List(5000), Contains("z/deep/er/victim"));
  ASSERT_THAT(reports_, SizeIs(1));
  EXPECT_THAT(reports_[0], HasSubstr("stopped after 5000 files and folders; 1 folder was not"));
  EXPECT_THAT(reports_[0], HasSubstr("such as " + (data_ / "a").string()));
  EXPECT_THAT(List(200'000), SizeIs(6001));
  EXPECT_THAT(reports_, IsEmpty());
}

TEST_F(HostileFolders, ManySubfoldersLeaveOthersTheirShare) {
  for (int i = 0; i < 300; ++i) {
    for (int k = 0; k < 3; ++k) Write(absl::StrCat("a/", i, "/", k));
  }
  Write("z/1/2/3/victim");
  EXPECT_THAT(List(400), Contains("z/1/2/3/victim"));
  EXPECT_THAT(reports_, SizeIs(1));
}

TEST_F(HostileFolders, KnownFilesStayWhereTheWalkStops) {
  for (int i = 0; i < 50; ++i) Write(absl::StrCat("a/", i));
  const std::string deep = Write("a/sub/of/known");
  const std::string gone = (data_ / "z/gone").string();
  Write("z/new");
  const std::vector<std::string> files = List(45, {deep, gone});
  EXPECT_THAT(files, Contains("a/sub/of/known"));
  EXPECT_THAT(files, Contains("z/new"));
  EXPECT_THAT(files, ::testing::Not(Contains("z/gone"))) << "its folder was listed to the end";
}

TEST_F(HostileFolders, AKnownStormStaysWhenItsFolderIsFilled) {
  Write("a/known");
  Write("z/victim");
  CatalogueScan scan = Scanner(40);
  EXPECT_THAT(Ids(Scan(scan)), ElementsAre("known", "victim"));
  for (int i = 0; i < 100; ++i) Write(absl::StrCat("a/notes", i));
  const testing::CapturedLog log;
  EXPECT_THAT(Ids(Scan(scan)), ElementsAre("known", "victim"));
  EXPECT_THAT(Ids(Scan(scan)), ElementsAre("known", "victim"));
  EXPECT_THAT(log.Text(), HasSubstr("the search stopped after 40 files and folders"));
  fs::remove(data_ / "a/known");
  EXPECT_THAT(Ids(Scan(scan)), ElementsAre("victim"));
}

TEST_F(HostileFolders, TheLogOfFilesLeftOutIsLimited) {
  for (int i = 0; i < 1000; ++i) Write(absl::StrCat("empty", i), "");
  Write("storm");
  const testing::CapturedLog log;
  CatalogueScan scan = Scanner();
  EXPECT_THAT(Ids(Scan(scan)), ElementsAre("storm"));
  EXPECT_EQ(described_, 1) << "an empty file needs no reader";
  const std::string text = log.Text();
  EXPECT_LE(std::ranges::count(text, '\n'), 22);
  EXPECT_THAT(text, HasSubstr("empty0: is empty; write it again, or remove it"));
  EXPECT_THAT(text, HasSubstr("left out: 980 more files, of which the last is "));
  time_.Advance(minutes(2));
  Scan(scan);
  EXPECT_EQ(log.Text(), text) << "nothing is new";
}

TEST_F(HostileFolders, SlowFilesWithholdNoStormOfAnotherFolder) {
  for (int i = 0; i < 30; ++i) Write(absl::StrCat("a/slow", i));
  Write("z/victim");
  const testing::CapturedLog log;
  CatalogueScan scan = Scanner();
  const auto began = time_.Now();
  CatalogueScan::Result result = Scan(scan);
  EXPECT_TRUE(result.is_unfinished);
  EXPECT_TRUE(result.has_untried);
  EXPECT_THAT(Ids(result), IsEmpty());
  EXPECT_THAT(Ids(Scan(scan)), ElementsAre("victim"));
  EXPECT_LT(time_.Now() - began, seconds(10));
  int scans = 0;
  bool was_left_untried = true;
  for (result = Scan(scan); result.is_unfinished && scans < 1000; result = Scan(scan), ++scans) {
    EXPECT_THAT(Ids(result), ElementsAre("victim"));
    was_left_untried = was_left_untried && result.has_untried;
  }
  EXPECT_LT(scans, 1000) << "each file is refused at last";
  EXPECT_FALSE(was_left_untried);
  EXPECT_THAT(log.Text(), HasSubstr("slow29: its reader was ended"));
}

TEST_F(HostileFolders, AStormThatArrivesWhileSlowFilesAreTriedIsListedSoon) {
  for (int i = 0; i < 30; ++i) Write(absl::StrCat("a/slow", i));
  Write("z/victim");
  CatalogueScan scan = Scanner();
  for (int scans = 0; Ids(Scan(scan)).empty(); ++scans) ASSERT_LT(scans, 100);
  Write("z/later");
  const auto written = time_.Now();
  while (Ids(Scan(scan)).size() < 2) {
    // One slow file may be tried with patience meanwhile.
    ASSERT_LT(time_.Now() - written, minutes(3));
  }
}

TEST_F(HostileFolders, AGoodFileBesideASlowOneIsDescribedAlone) {
  Write("a-slow");
  Write("storm");
  CatalogueScan scan = Scanner();
  const auto began = time_.Now();
  Scan(scan);
  Scan(scan);
  EXPECT_THAT(Ids(Scan(scan)), ElementsAre("storm"));
  EXPECT_LT(time_.Now() - began, seconds(10));
}

TEST_F(HostileFolders, AFileThatIsNoStormIsTriedLessAndLessOften) {
  Write("notes");
  CatalogueScan scan = Scanner();
  for (int second = 0; second < 3600; second += 10) {
    Scan(scan);
    time_.Advance(seconds(10));
  }
  EXPECT_GE(described_, 5);
  EXPECT_LE(described_, 10);
}

TEST_F(HostileFolders, FilesOfManyTimesAreDescribedTogetherOnce) {
  Write("part-0-1-2-3-4-5-6-7");
  Write("part-7-6-5-4-3-2-1-0");
  const auto storms = FindStorms({data_.string()}, Formats());
  ASSERT_TRUE(storms.ok()) << storms.status();
  EXPECT_THAT(*storms, SizeIs(1));
  EXPECT_EQ(together_, 1);
}

TEST_F(HostileFolders, TimesOfManyFilesLeaveOthersTheirShare) {
  // Each time consists of another set of files.
  for (int i = 0; i < 30; ++i) Write(absl::StrCat("a/part-", i));
  Write("z/part-0");
  CatalogueScan scan = Scanner();
  int scans = 0;
  std::size_t listed = 0;
  for (bool has_victim = false; !has_victim && scans < 5; ++scans) {
    const CatalogueScan::Result result = Scan(scan);
    listed = result.storms.size();
    has_victim = std::ranges::any_of(result.storms, [](const CataloguedStorm& storm) {
      return absl::StrContains(storm.info.files.front(), "/z/");
    });
    EXPECT_TRUE(result.is_unfinished);
  }
  EXPECT_LT(scans, 5);
  EXPECT_GE(listed, 1U);
  while (Scan(scan).is_unfinished && scans < 100) ++scans;
  EXPECT_EQ(together_, 31);
}

TEST_F(HostileFolders, AStormHasFewNotesHoweverManyTimesAreDouble) {
  StormFile file = Described("/d/storm");
  file.times.assign(100'000, absl::UnixEpoch());
  const CataloguedStorm storm = AssembleStorm("storm", {file});
  EXPECT_EQ(storm.notes.size(), 101U);
  EXPECT_EQ(storm.notes.back(), "storm: 99899 more of its times are there several times");
  EXPECT_THAT(storm.info.times, SizeIs(1));
}

TEST_F(HostileFolders, ASeriesKeepsTheLatestOfTooManyTimes) {
  StormFile early = Described("/d/storm_1");
  early.times = {absl::UnixEpoch(), absl::UnixEpoch() + absl::Seconds(1)};
  StormFile late = Described("/d/storm_2");
  late.times.clear();
  for (std::size_t i = 1; i < storm_files::kMaxTimes; ++i) {
    late.times.push_back(absl::UnixEpoch() + absl::Seconds(static_cast<std::int64_t>(i + 1)));
  }
  const CataloguedStorm storm = AssembleStorm("storm", {early, late});
  EXPECT_THAT(storm.info.times, SizeIs(storm_files::kMaxTimes));
  EXPECT_EQ(storm.info.times.front().valid_time, "1970-01-01T00:00:01Z");
  EXPECT_EQ(storm.info.times.front().elapsed_s, 0.0);
  EXPECT_THAT(storm.notes, Contains(HasSubstr("its earliest 1 times")));
}

// The store is locked while it takes the result of a search. The work is proportional to the number
// of storms, of their files and of their times.
TEST_F(HostileFolders, VeryManyStormsOfOneNameAreListedAndMatchedInTime) {
  constexpr int kStorms = 20'000;
  FoundByPath found;
  for (int i = 0; i < kStorms; ++i) {
    const std::string path = absl::StrCat("/d/", i, "/storm.nc");
    found["/d"].push_back({"storm", {Described(path)}});
  }
  const StormSearch search{.describe = {},
                           .describe_together = {},
                           .on_unlisted = {},
                           .on_folder = {},
                           .examples = "",
                           .answers = [](const std::string&) { return false; },
                           .found = &found};
  const auto began = std::chrono::steady_clock::now();
  const auto storms = FindStorms({"/d"}, search);
  ASSERT_TRUE(storms.ok()) << storms.status();
  ASSERT_THAT(*storms, SizeIs(kStorms));
  std::vector<const CataloguedStorm*> known;
  for (const CataloguedStorm& storm : *storms) known.push_back(&storm);
  const auto match = MatchStorms(known, *storms);
  for (std::size_t i = 0; i < match.size(); ++i) EXPECT_EQ(match[i], i);
  // This takes less than a second. It took minutes when each storm was compared with each other.
  EXPECT_LT(std::chrono::steady_clock::now() - began, seconds(60));
}

TEST(FairFolders, EachLevelSharesItsTime) {
  FairFolders turns;
  const FolderSet waiting = {"/d", "/d/a/1", "/d/a/2", "/d/a-b", "/d/z", "/other"};
  std::map<std::string, int> served;
  for (int i = 0; i < 80; ++i) {
    const std::string& folder = turns.Next(waiting);
    ++served[folder];
    turns.Used(folder, 1.0);
  }
  // Half of the turns are for /other, and half for /d. Those of /d are shared equally by its own
  // files, /d/a, /d/a-b and /d/z.
  EXPECT_EQ(served["/other"], 40);
  EXPECT_EQ(served["/d"], 10);
  EXPECT_EQ(served["/d/a/1"], 5);
  EXPECT_EQ(served["/d/a/2"], 5);
  EXPECT_EQ(served["/d/a-b"], 10);
  EXPECT_EQ(served["/d/z"], 10);
}

TEST(FairFolders, OfEqualFoldersTheOneThatCameFirstIsServed) {
  FairFolders turns;
  EXPECT_EQ(turns.Next({"m", "z"}), "m");
  turns.Used("m", 1.0);
  // A folder with an earlier name appears later, but z has waited longer and gets its turn first.
  EXPECT_EQ(turns.Next({"a", "m", "z"}), "z");
  turns.KeepOnly({"z"});
  EXPECT_EQ(turns.Next({"m", "z"}), "z") << "what was used is forgotten, and so is when it came";
}

TEST(LeftOutLog, LimitsTheLinesOfAMinute) {
  const testing::CapturedLog log;
  LeftOutLog left_out;
  const LeftOutLog::Time start{std::chrono::hours(1)};
  for (int i = 0; i < 100; ++i) left_out.Add(absl::StrCat("file ", i), false, start);
  left_out.Summarize(start);
  for (int i = 100; i < 200; ++i) left_out.Add(absl::StrCat("file ", i), false, start);
  left_out.Summarize(start);
  EXPECT_EQ(std::ranges::count(log.Text(), '\n'), 21);
  EXPECT_THAT(log.Text(), HasSubstr("left out: 80 more files, of which the last is file 99"));
  left_out.Summarize(start + minutes(1));
  EXPECT_THAT(log.Text(), HasSubstr("left out: 100 more files, of which the last is file 199"));
  left_out.Add("file 200", true, start + minutes(1));
  EXPECT_THAT(log.Text(), HasSubstr("left out: file 200"));
}

}  // namespace
}  // namespace thunderhead::storm_store
