// Tests of WRF files whose dimensions other programs have renamed or dropped.
#include "storm_files/wrf_layout.h"

#include "tests/unit/storm_files/wrf_kind_test.h"

namespace thunderhead::storm_files {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::SyntheticWrf;
using testing::WrfCell;

class WrfLayoutTest : public WrfKindTest {};

TEST_F(WrfLayoutTest, InvariantsMayHaveNoTime) {
  SyntheticWrf file = Cloud();
  file.times = {"2013-05-20_20:00:00", "2013-05-20_20:10:00"};
  file.terrain_m = [](int x, int) { return 100.0 * x; };
  file.columns["LU_INDEX"] = [](const WrfCell&) { return 16.0; };
  file.land_use_table = "USGS";
  file.without_time = {"XLAT", "XLONG", "HGT", "LU_INDEX", "PHB", "PB"};
  const auto described = Describe(file);
  ASSERT_TRUE(described.ok()) << described.status();
  EXPECT_NEAR(described->latitude_deg.value_or(0), 35.01799, 1e-4);
  EXPECT_NEAR(described->longitude_deg.value_or(0), -96.98352, 1e-4);
  EXPECT_TRUE(described->middles.empty());
  for (const std::size_t record : {0U, 1U}) {
    const auto fields = described->reader->Read(record, std::nullopt, {});
    ASSERT_TRUE(fields.ok()) << fields.status();
    EXPECT_FLOAT_EQ(fields->terrain_height_m[3], 300.0F);
    EXPECT_NEAR(ColumnPath(*fields, 0, 2, 1), 1e-3 * kDryDensity_kg_per_m3 * 3800.0, 1e-3);
    EXPECT_FALSE(fields->land.Empty());
  }
}

TEST_F(WrfLayoutTest, InvariantsMayHaveOneTimeOfTheirOwn) {
  SyntheticWrf file = Cloud();
  file.times = {"2013-05-20_20:00:00", "2013-05-20_20:10:00"};
  file.terrain_m = [](int x, int) { return 100.0 * x; };
  file.at_one_time = {"XLAT", "XLONG", "HGT", "PHB", "PB"};
  for (const std::size_t record : {0U, 1U}) {
    const auto fields = Read(file, record);
    ASSERT_TRUE(fields.ok()) << fields.status();
    EXPECT_FLOAT_EQ(fields->terrain_height_m[3], 300.0F);
    EXPECT_NEAR(ColumnPath(*fields, 0, 2, 1), 1e-3 * kDryDensity_kg_per_m3 * 3800.0, 1e-3);
  }
}

TEST_F(WrfLayoutTest, AFileWithoutTimeHasOneTime) {
  SyntheticWrf file = Cloud();
  file.without_time = {"PH", "PHB", "P", "PB", "T", "QVAPOR", "QCLOUD", "HGT", "XLAT", "XLONG"};
  const auto with_times_row = Describe(file);
  ASSERT_TRUE(with_times_row.ok()) << with_times_row.status();
  file.without_time.insert("Times");
  const auto described = Describe(file);
  ASSERT_TRUE(described.ok()) << described.status();
  EXPECT_EQ(described->times, with_times_row->times);
  EXPECT_EQ(described->times.size(), 1U);
  const auto fields = described->reader->Read(0, std::nullopt, {});
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_NEAR(ColumnPath(*fields, 0, 0, 0), 1e-3 * kDryDensity_kg_per_m3 * 4000.0, 1e-3);
}

TEST_F(WrfLayoutTest, FieldsWithoutTimeAreRefusedInAFileOfSeveralTimes) {
  SyntheticWrf file = Cloud();
  file.times = {"2013-05-20_20:00:00", "2013-05-20_20:10:00"};
  file.without_time = {"QCLOUD"};
  EXPECT_THAT(Message(file), HasSubstr("QCLOUD has dimensions (8, 3, 4) where (2, 8, 3, 4)"));
}

TEST_F(WrfLayoutTest, ReadsDimensionsByOtherNames) {
  SyntheticWrf file = Cloud();
  file.renamed_dimensions = {{"Time", "XTIME"},
                             {"bottom_top", "lev"},
                             {"bottom_top_stag", "lev_2"},
                             {"south_north", "y"},
                             {"west_east", "x"}};
  file.omitted = {"Times"};
  file.minutes = {480.0};
  file.units["XTIME"] = "minutes since 2013-05-20 12:00:00";
  const auto described = Describe(file);
  ASSERT_TRUE(described.ok()) << described.status();
  EXPECT_EQ(described->cells, glm::ivec3(4, 3, 8));
  EXPECT_EQ(absl::FormatTime(described->times.at(0), absl::UTCTimeZone()),
            "2013-05-20T20:00:00+00:00");
  const auto fields = described->reader->Read(0, std::nullopt, {});
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_NEAR(ColumnPath(*fields, 0, 0, 0), 1e-3 * kDryDensity_kg_per_m3 * 4000.0, 1e-3);
}

TEST_F(WrfLayoutTest, NamesADimensionThatIsMissing) {
  SyntheticWrf file = Cloud();
  file.renamed_dimensions = {{"bottom_top", "lev"}};
  file.omitted = {"P", "PB", "T", "QVAPOR"};
  file.mixing_ratios.clear();
  EXPECT_THAT(Message(file), AllOf(HasSubstr("no dimension bottom_top"), HasSubstr(path_)));
}

TEST_F(WrfLayoutTest, ASmallerNumberOfInterfacesIsRefused) {
  SyntheticWrf file = Cloud();
  file.one_level_short = {"PHB"};
  EXPECT_THAT(Message(file), HasSubstr("PHB"));
}

TEST_F(WrfLayoutTest, AFileWithoutRecordsHasNoTimes) {
  SyntheticWrf file = Cloud();
  file.times.clear();
  const absl::Status status = Describe(file).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kDataLoss);
  EXPECT_THAT(std::string(status.message()),
              AllOf(HasSubstr("holds no times: its dimension Time is empty"),
                    Not(HasSubstr("still be writing"))));
}

}  // namespace
}  // namespace thunderhead::storm_files
