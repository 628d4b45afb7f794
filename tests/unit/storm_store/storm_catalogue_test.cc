#include "storm_store/storm_catalogue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <stop_token>

#include "tests/support/synthetic_cf.h"
#include "tests/support/synthetic_wrf.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::storm_store {
namespace {

using ::testing::ElementsAre;
using ::testing::SizeIs;
using testing::SyntheticCf;
using testing::SyntheticWrf;
using testing::TemporaryFolder;
using testing::WrfCell;

class StormCatalogue : public ::testing::Test {
 protected:
  void Write(const std::string& name, const std::vector<std::string>& hours,
             const std::function<void(SyntheticWrf&)>& change = {}) {
    SyntheticWrf file;
    file.times.clear();
    for (const std::string& hour : hours) file.times.push_back("2013-05-20_" + hour + ":00:00");
    file.mixing_ratios["QCLOUD"] = [](const WrfCell&) { return 1e-3; };
    if (change) change(file);
    const std::filesystem::path path = storms_ / name;
    std::filesystem::create_directories(path.parent_path());
    testing::WriteWrf(file, path.string());
  }

  std::vector<CataloguedStorm> Find() {
    auto storms = FindStorms({storms_.string()}, storm_files::StormFormats::BuiltIn());
    EXPECT_TRUE(storms.ok()) << storms.status();
    return storms.ok() ? *std::move(storms) : std::vector<CataloguedStorm>{};
  }

  TemporaryFolder folder_;
  std::filesystem::path storms_ = folder_.Path() / "moore";
};

std::vector<std::string> Ids(const std::vector<CataloguedStorm>& storms) {
  std::vector<std::string> ids;
  ids.reserve(storms.size());
  for (const CataloguedStorm& storm : storms) ids.push_back(storm.info.id);
  return ids;
}

std::vector<std::string> Hours(const CataloguedStorm& storm) {
  std::vector<std::string> hours;
  for (const StormTime& time : storm.info.times) hours.push_back(time.valid_time.substr(11, 2));
  return hours;
}

TEST_F(StormCatalogue, TakesFilesOfARunAsOneSeriesInOrderOfTime) {
  Write("wrfout_d01_2013-05-20_20:00:00", {"20"});
  Write("history_b", {"19"});
  Write("history_a", {"21", "22"});
  const auto storms = Find();
  ASSERT_THAT(storms, SizeIs(1));
  EXPECT_EQ(storms[0].info.id, "moore");
  EXPECT_EQ(storms[0].info.title, "moore (WRF V4.5)");
  EXPECT_THAT(Hours(storms[0]), ElementsAre("19", "20", "21", "22"));
  EXPECT_EQ(storms[0].info.times[0].valid_time, "2013-05-20T19:00:00Z");
  EXPECT_EQ(storms[0].info.times[3].elapsed_s, 3 * 3600.0);
  EXPECT_THAT(storms[0].info.files, SizeIs(3));
  // The last time is the second record of the first file in order of name.
  EXPECT_EQ(storms[0].sources[3].file, 0U);
  EXPECT_EQ(storms[0].sources[3].record, 1U);
  EXPECT_THAT(storms[0].info.files[storms[0].sources[0].file], ::testing::EndsWith("history_b"));
}

TEST_F(StormCatalogue, KeepsTheLaterFileOfATimeThatIsThereTwice) {
  Write("run_1", {"18", "19", "20"});
  Write("run_2_restarted", {"20", "21", "22"});
  const auto storms = Find();
  ASSERT_THAT(storms, SizeIs(1));
  EXPECT_THAT(Hours(storms[0]), ElementsAre("18", "19", "20", "21", "22"));
  EXPECT_EQ(storms[0].sources[2].file, 1U);
  EXPECT_EQ(storms[0].sources[2].record, 0U);
}

TEST_F(StormCatalogue, TakesRunsOfTheSameTimesAsStormsOfTheirOwn) {
  Write("member 1.nc", {"18", "19"});
  Write("member 2.nc", {"18", "19"});
  const std::vector<CataloguedStorm> storms = Find();
  ASSERT_THAT(Ids(storms), ElementsAre("member-1", "member-2"));
  // A copy under another name is such a file, so both storms say so.
  EXPECT_THAT(storms[0].info.assumptions,
              ::testing::Contains(::testing::StartsWith("member 2.nc has most or all of the same "
                                                        "times on the same grid")));
  EXPECT_THAT(storms[1].info.assumptions,
              ::testing::Contains(::testing::StartsWith("member 1.nc has most or all")));
  Write("member 3.nc", {"18", "19"});
  EXPECT_THAT(Find()[2].info.assumptions,
              ::testing::Contains(::testing::StartsWith("member 1.nc and 1 more files have most")));
}

TEST_F(StormCatalogue, TellsRunsApartByGridDomainAndStart) {
  Write("a", {"18"});
  Write("b", {"19"}, [](SyntheticWrf& file) { file.nx = 5; });
  Write("c", {"20"}, [](SyntheticWrf& file) { file.domain = 2; });
  Write("d", {"21"}, [](SyntheticWrf& file) { file.simulation_start = "2013-05-20_00:00:00"; });
  Write("e", {"22"}, [](SyntheticWrf& file) { file.dx_m = 500.0; });
  EXPECT_THAT(Ids(Find()), ElementsAre("a", "b", "c", "d", "e"));
}

// Writes a CF file with one time, and the time at which its forecast began, in hours since
// midnight.
void WriteForecast(const std::filesystem::path& path, double valid_h, double start_h) {
  SyntheticCf file = testing::ExtinctionFile(2, 2, 2, 1000.0, 1000.0, 500.0,
                                             [](auto, auto, auto) { return 1e-3; });
  const auto hour = [&](const std::string& name, const std::string& standard_name, double value) {
    file.variables.push_back(
        {name,
         {},
         {{"units", "hours since 2013-05-20"}, {"standard_name", standard_name}},
         [value](const auto&) { return value; }});
  };
  hour("valid", "time", valid_h);
  hour("start", "forecast_reference_time", start_h);
  std::filesystem::create_directories(path.parent_path());
  testing::WriteCf(file, path.string());
}

TEST_F(StormCatalogue, TellsForecastsThatBeganAtDifferentTimesApart) {
  WriteForecast(storms_ / "a.nc", 19.0, 18.0);
  WriteForecast(storms_ / "b.nc", 20.0, 18.0);
  WriteForecast(storms_ / "c.nc", 20.0, 19.0);
  const std::vector<CataloguedStorm> storms = Find();
  ASSERT_THAT(Ids(storms), ElementsAre("c", "moore"));
  EXPECT_EQ(storms[0].info.run_start, "2013-05-20T19:00:00Z");
  EXPECT_THAT(Hours(storms[1]), ElementsAre("19", "20"));
  EXPECT_EQ(storms[1].info.run_start, "2013-05-20T18:00:00Z");
}

TEST_F(StormCatalogue, TakesAnalysesAsOneSeriesWithoutAStart) {
  WriteForecast(storms_ / "a.nc", 18.0, 18.0);
  WriteForecast(storms_ / "b.nc", 19.0, 19.0);
  const std::vector<CataloguedStorm> storms = Find();
  ASSERT_THAT(storms, SizeIs(1));
  EXPECT_THAT(Hours(storms[0]), ElementsAre("18", "19"));
  EXPECT_FALSE(storms[0].info.run_start.has_value());
}

TEST_F(StormCatalogue, TellsTheNestsOfARunApart) {
  for (const int domain : {1, 2}) {
    const auto nest = [=](SyntheticWrf& file) { file.domain = domain; };
    Write("wrfout_d0" + std::to_string(domain) + "_18", {"18"}, nest);
    Write("wrfout_d0" + std::to_string(domain) + "_19", {"19"}, nest);
  }
  EXPECT_THAT(Ids(Find()), ElementsAre("moore-d01", "moore-d02"));
}

TEST_F(StormCatalogue, LooksIntoSubfoldersAndLeavesOutWhatIsNoStorm) {
  Write("east/one.nc", {"18"});
  Write("east/deeper/two.nc", {"18"});
  Write("west/one.nc", {"18"});
  Write(".hidden.nc", {"18"});
  std::ofstream(storms_ / "README.md") << "about these storms";
  std::ofstream(storms_ / "broken.nc") << "CDF\x01";
  EXPECT_THAT(Ids(Find()), ElementsAre("one", "one-2", "two"));
}

TEST_F(StormCatalogue, ARequestToStopEndsTheSearchBetweenFiles) {
  for (const char* name : {"a/one", "b/two", "c/three"}) Write(name, {"00"});
  std::stop_source stop;
  int opened = 0;
  const StormSearch search{.describe =
                               [&](const std::vector<std::string>& paths) {
                                 opened += static_cast<int>(paths.size());
                                 if (!paths.empty()) stop.request_stop();
                                 return DescribeInBatches(paths,
                                                          storm_files::StormFormats::BuiltIn(),
                                                          [] { return true; });
                               },
                           .describe_together = {},
                           .on_unlisted = {},
                           .on_folder = {},
                           .examples = {},
                           .stop = stop.get_token()};
  const auto found = FindStorms({storms_.string()}, search);
  EXPECT_EQ(found.status().code(), absl::StatusCode::kCancelled);
  EXPECT_EQ(opened, 1);
  const auto at_once =
      FindStorms({storms_.string()}, storm_files::StormFormats::BuiltIn(), {}, stop.get_token());
  EXPECT_EQ(at_once.status().code(), absl::StatusCode::kCancelled);
}

TEST_F(StormCatalogue, TakesAFileGivenTwiceOnce) {
  Write("one.nc", {"18"});
  const auto storms = FindStorms({storms_.string(), (storms_ / "one.nc").string()},
                                 storm_files::StormFormats::BuiltIn());
  ASSERT_TRUE(storms.ok()) << storms.status();
  EXPECT_THAT(Ids(*storms), ElementsAre("one"));
}

TEST_F(StormCatalogue, BeginsWithThePathGivenFirst) {
  for (const char* name : {"a.nc", "b.nc", "c.nc"}) Write(name, {"18"});
  const auto storms = FindStorms({(storms_ / "b.nc").string(), storms_.string()},
                                 storm_files::StormFormats::BuiltIn());
  ASSERT_TRUE(storms.ok()) << storms.status();
  EXPECT_THAT(Ids(*storms), ElementsAre("b", "a", "c"));
}

TEST_F(StormCatalogue, MakesIdsOfColons) {
  Write("wrfout_d01_2013-05-20_18:00:00", {"18"});
  EXPECT_THAT(Ids(Find()), ElementsAre("wrfout_d01_2013-05-20_18-00-00"));
}

TEST_F(StormCatalogue, FailsForAFileGivenByNameThatIsNoStorm) {
  Write("one.nc", {"18"});
  const std::string notes = (storms_ / "notes.txt").string();
  std::ofstream(notes) << "notes";
  const auto storms =
      FindStorms({(storms_ / "one.nc").string(), notes}, storm_files::StormFormats::BuiltIn());
  EXPECT_EQ(storms.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(storms.status().message()), ::testing::HasSubstr(notes));
}

}  // namespace
}  // namespace thunderhead::storm_store
