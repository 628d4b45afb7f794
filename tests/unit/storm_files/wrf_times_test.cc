// Tests of the times of WRF files: Times, XTIME in its own units, dates of zero, repeated times.
#include "storm_files/wrf_times.h"

#include "storm_store/storm_catalogue.h"
#include "tests/unit/storm_files/wrf_kind_test.h"

namespace thunderhead::storm_files {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::SyntheticWrf;
using testing::WrfCell;

class WrfTimesTest : public WrfKindTest {
 protected:
  std::vector<std::string> Times(const SyntheticWrf& file) {
    const auto described = Describe(file);
    EXPECT_TRUE(described.ok()) << described.status();
    std::vector<std::string> texts;
    if (!described.ok()) return texts;
    for (const absl::Time time : described->times) {
      texts.push_back(absl::FormatTime("%E4Y-%m-%d %H:%M:%S", time, absl::UTCTimeZone()));
    }
    assumptions_ = Assumptions(*described);
    return texts;
  }

  std::string assumptions_;
};

TEST_F(WrfTimesTest, XtimeHasItsOwnUnits) {
  SyntheticWrf file = Cloud();
  file.times = {"", ""};
  file.omitted = {"Times"};
  file.minutes = {20.0, 21.0};
  file.units["XTIME"] = "hours since 2013-05-20 00:00:00";
  file.simulation_start = "2013-05-20_18:00:00";
  EXPECT_THAT(Times(file), ElementsAre("2013-05-20 20:00:00", "2013-05-20 21:00:00"));
  file.units["XTIME"] = "days since 2013-05-01";
  EXPECT_THAT(Times(file), ElementsAre("2013-05-21 00:00:00", "2013-05-22 00:00:00"));
  file.units["XTIME"] = "minutes";
  EXPECT_THAT(Times(file), ElementsAre("2013-05-20 18:20:00", "2013-05-20 18:21:00"));
}

TEST_F(WrfTimesTest, AnotherCalendarOfXtimeIsRefused) {
  SyntheticWrf file = Cloud();
  file.omitted = {"Times"};
  file.minutes = {20.0};
  file.units["XTIME"] = "hours since 2013-05-20 00:00:00";
  file.texts["XTIME"]["calendar"] = "noleap";
  EXPECT_THAT(Message(file), HasSubstr("XTIME has the calendar 'noleap'"));
}

TEST_F(WrfTimesTest, ARunWithoutADateBeginsInYearOne) {
  SyntheticWrf file = Cloud();
  file.simulation_start = "0000-00-00_00:00:00";
  file.times = {"0000-00-00_00:10:00", "0000-00-00_00:20:00"};
  EXPECT_THAT(Times(file), ElementsAre("0001-01-01 00:10:00", "0001-01-01 00:20:00"));
  EXPECT_THAT(assumptions_, HasSubstr("0000-00-00"));
  // If Times stays at zero in a run without a date, XTIME gives the times.
  file.times = {"0000-00-00_00:00:00", "0000-00-00_00:00:00"};
  file.minutes = {30.0, 40.0};
  file.units["XTIME"] = "minutes since 0000-00-00 00:00:00";
  EXPECT_THAT(Times(file), ElementsAre("0001-01-01 00:30:00", "0001-01-01 00:40:00"));
}

TEST_F(WrfTimesTest, TheLaterRecordOfARepeatedTimeIsUsed) {
  SyntheticWrf file;
  file.times = {"2013-05-20_20:00:00", "2013-05-20_20:10:00", "2013-05-20_20:00:00"};
  file.mixing_ratios["QCLOUD"] = [](const WrfCell& cell) { return 1e-3 * (1 + cell.record); };
  auto described = Describe(file);
  ASSERT_TRUE(described.ok()) << described.status();
  const storm_store::CataloguedStorm storm =
      storm_store::AssembleStorm("storm", {*std::move(described)});
  ASSERT_EQ(storm.sources.size(), 2U);
  EXPECT_EQ(storm.sources[0].record, 2U);
  EXPECT_EQ(storm.sources[1].record, 1U);
  EXPECT_THAT(storm.notes, ElementsAre(HasSubstr("2013-05-20T20:00:00Z")));
}

TEST_F(WrfTimesTest, MoreTimesThanRecordsAreRefused) {
  SyntheticWrf file = Cloud();
  file.times = {"2013-05-20_20:00:00", "2013-05-20_20:10:00"};
  file.without_time = {"PH", "PHB", "P", "PB", "T", "QVAPOR", "QCLOUD", "HGT", "XLAT", "XLONG"};
  EXPECT_THAT(Message(file), HasSubstr("has 2 times, but 1 records"));
}

}  // namespace
}  // namespace thunderhead::storm_files
