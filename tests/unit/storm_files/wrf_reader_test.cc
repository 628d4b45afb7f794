// Tests of reading synthetic files with known contents: terrain, subsets of fields, packing,
// missing values.
#include "storm_files/wrf_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "tests/support/captured_log.h"
#include "tests/support/synthetic_wrf.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::storm_files {
namespace {

using physics::Hydrometeor;
using testing::SyntheticWrf;
using testing::TemporaryFolder;
using testing::WrfCell;
using testing::WrfFormat;

// The density of SyntheticWrf's air: 80 kPa, 310 K, 10 g/kg (see layer_air_test).
constexpr double kDensity_kg_per_m3 = 0.94321;

class WrfReader : public ::testing::Test {
 protected:
  absl::StatusOr<volume::HydrometeorFields> Read(
      const SyntheticWrf& file, std::size_t record = 0,
      const std::optional<VerticalGrid>& grid = std::nullopt) {
    const std::string path = folder_.File("wrfout");
    testing::WriteWrf(file, path);
    absl::StatusOr<WrfMetadata> metadata = ReadWrfMetadata(path);
    if (!metadata.ok()) return metadata.status();
    return ReadWrfTime(*metadata, record, grid, {});
  }

  TemporaryFolder folder_;
};

double ColumnPath(const volume::HydrometeorFields& fields, std::size_t field, int x, int y) {
  double path = 0.0;
  for (int z = 0; z < fields.grid.cells.z; ++z) {
    path += fields.fields[field].concentration_kg_per_m3[fields.grid.Offset(x, y, z)] *
            fields.grid.spacing_m.z;
  }
  return path;
}

SyntheticWrf Uniform(double mixing_ratio) {
  SyntheticWrf file;
  file.mixing_ratios["QCLOUD"] = [=](const WrfCell&) { return mixing_ratio; };
  return file;
}

TEST_F(WrfReader, GivesTheMassOfUniformCloud) {
  const auto fields = Read(Uniform(1e-3));
  ASSERT_TRUE(fields.ok()) << fields.status();
  const volume::RegularGrid& grid = fields->grid;
  EXPECT_EQ(grid.cells, glm::ivec3(4, 3, 9));  // 8 layers of 500 m and space above
  EXPECT_NEAR(grid.spacing_m.z, 500.0, 1e-2);
  EXPECT_EQ(grid.spacing_m.x, 1000.0);
  EXPECT_EQ(grid.spacing_m.y, 2000.0);
  EXPECT_EQ(grid.low_corner_m.x, -2000.0);
  EXPECT_EQ(grid.low_corner_m.y, -3000.0);
  ASSERT_EQ(fields->fields.size(), 1U);
  const volume::HydrometeorField& cloud = fields->fields[0];
  EXPECT_EQ(cloud.hydrometeor, Hydrometeor::kCloud);
  EXPECT_EQ(cloud.variable, "QCLOUD");
  EXPECT_NEAR(cloud.concentration_kg_per_m3[grid.Offset(2, 1, 4)], kDensity_kg_per_m3 * 1e-3, 1e-8);
  EXPECT_NEAR(cloud.statistics.mean_water_path_kg_per_m2, kDensity_kg_per_m3 * 4.0, 1e-4);
  EXPECT_EQ(fields->condensate, (volume::CellBox{{0, 0, 0}, {4, 3, 8}}));
}

TEST_F(WrfReader, ReadsEveryFormatOfNetcdf) {
  for (const WrfFormat format :
       {WrfFormat::kNetcdf4, WrfFormat::kClassic, WrfFormat::kOffset64, WrfFormat::kCdf5}) {
    SyntheticWrf file = Uniform(1e-3);
    file.format = format;
    const auto fields = Read(file);
    ASSERT_TRUE(fields.ok()) << fields.status();
    EXPECT_NEAR(ColumnPath(*fields, 0, 1, 1), kDensity_kg_per_m3 * 4.0, 1e-4);
  }
}

// Every cell that lies entirely within its column has the same mass, and none lies below the
// ground.
TEST_F(WrfReader, FollowsSlopingTerrain) {
  SyntheticWrf file = Uniform(2e-3);
  file.nx = 20;
  file.levels = 16;
  file.terrain_m = [](int x, int y) { return 100.0 * x + 10.0 * y; };
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  const volume::RegularGrid& grid = fields->grid;
  EXPECT_EQ(grid.low_corner_m.z, 0.0);
  EXPECT_LE(grid.cells.z, 20);
  for (int y = 0; y < file.ny; ++y) {
    for (int x = 0; x < file.nx; ++x) {
      const double terrain_m = file.terrain_m(x, y);
      EXPECT_FLOAT_EQ(fields->terrain_height_m[grid.Offset(x, y, 0)], terrain_m);
      const double expected = 2e-3 * kDensity_kg_per_m3 * (file.top_m - terrain_m);
      EXPECT_NEAR(ColumnPath(*fields, 0, x, y) / expected, 1.0, 1e-4);
      for (int z = 0; z < grid.cells.z; ++z) {
        const double bottom_m = grid.low_corner_m.z + z * grid.spacing_m.z;
        const double top_m = bottom_m + grid.spacing_m.z;
        const float mass = fields->fields[0].concentration_kg_per_m3[grid.Offset(x, y, z)];
        if (top_m <= terrain_m - 1.0) {
          EXPECT_EQ(mass, 0.0F);
        }
        if (bottom_m >= terrain_m + 1.0 && top_m <= file.top_m - 1.0) {
          EXPECT_NEAR(mass, 2e-3 * kDensity_kg_per_m3, 1e-7);
        }
      }
    }
  }
}

TEST_F(WrfReader, TakesTheLowestInterfaceWhereTerrainIsLeftOut) {
  SyntheticWrf file = Uniform(1e-3);
  file.terrain_m = [](int x, int) { return 250.0 * x; };
  file.omitted = {"HGT"};
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_NEAR(fields->terrain_height_m[3], 750.0F, 0.01F);
}

TEST_F(WrfReader, TakesAirAsDryWhereVapourIsLeftOut) {
  SyntheticWrf file = Uniform(1e-3);
  file.omitted = {"QVAPOR"};
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_NEAR(ColumnPath(*fields, 0, 0, 0), 0.95838 * 4.0, 1e-4);
}

TEST_F(WrfReader, ReadsAnySubsetOfFieldsInTheirOrder) {
  SyntheticWrf file = Uniform(1e-3);
  file.mixing_ratios["QHAIL"] = [](const WrfCell&) { return 2e-3; };
  file.mixing_ratios["QRAIN"] = [](const WrfCell& cell) { return cell.level == 0 ? 1e-3 : 0.0; };
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  ASSERT_EQ(fields->fields.size(), 3U);
  EXPECT_EQ(fields->fields[0].hydrometeor, Hydrometeor::kCloud);
  EXPECT_EQ(fields->fields[1].hydrometeor, Hydrometeor::kRain);
  EXPECT_EQ(fields->fields[2].hydrometeor, Hydrometeor::kHail);
}

TEST_F(WrfReader, HoldsNoArrayForAFieldThatIsZero) {
  SyntheticWrf file = Uniform(1e-3);
  file.mixing_ratios["QICE"] = [](const WrfCell&) { return 0.0; };
  file.mixing_ratios["QSNOW"] = [](const WrfCell&) { return 1e-42; };  // denormal, counts as zero
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  ASSERT_EQ(fields->fields.size(), 3U);
  for (const std::size_t zero : {1U, 2U}) {
    EXPECT_TRUE(fields->fields[zero].concentration_kg_per_m3.empty());
    EXPECT_EQ(fields->fields[zero].statistics.maximum, 0.0F);
  }
}

TEST_F(WrfReader, ReadsAStormWithoutCondensate) {
  const auto fields = Read(Uniform(0.0));
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_TRUE(fields->condensate.Empty());
}

TEST_F(WrfReader, UnpacksShorts) {
  SyntheticWrf file = Uniform(1.5e-3);
  file.packed = {"QCLOUD", "PB"};
  file.fill_values["QCLOUD"] = -32'768;
  file.stored_values = {{"QCLOUD", {1, 2, 3, 0}, -32'768}};
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  const volume::FieldStatistics& statistics = fields->fields[0].statistics;
  EXPECT_NEAR(statistics.maximum, 1.5e-3, 1e-9);
  EXPECT_EQ(statistics.missing_cells, 1);
  EXPECT_NEAR(ColumnPath(*fields, 0, 0, 0), 1.5e-3 * kDensity_kg_per_m3 * 4000.0, 1e-3);
  EXPECT_NEAR(ColumnPath(*fields, 0, 1, 2), 1.5e-3 * kDensity_kg_per_m3 * 3500.0, 1e-3);
}

TEST_F(WrfReader, CountsNegativesAndMissingValuesAndDrawsNeither) {
  SyntheticWrf file = Uniform(1e-3);
  file.fill_values["QCLOUD"] = 0.25;  // an unusual value, but it is the file's own
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  file.stored_values = {
      {"QCLOUD", {0, 0, 1, 0}, -1e-13}, {"QCLOUD", {0, 0, 2, 0}, -3e-13},
      {"QCLOUD", {1, 0, 0, 0}, kNan},   {"QCLOUD", {1, 0, 1, 0}, kNan},
      {"QCLOUD", {1, 0, 2, 0}, 1e35},   {"QCLOUD", {1, 0, 3, 0}, 9.969209968386869e36},
      {"QCLOUD", {1, 0, 4, 0}, 1e35},   {"QCLOUD", {1, 0, 5, 0}, -999.0},
      {"QCLOUD", {1, 0, 6, 0}, 0.25},
  };
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  const volume::FieldStatistics& statistics = fields->fields[0].statistics;
  EXPECT_EQ(statistics.negative_cells, 2);
  EXPECT_EQ(statistics.missing_cells, 7);
  EXPECT_FLOAT_EQ(statistics.minimum, -3e-13F);
  EXPECT_FLOAT_EQ(statistics.maximum, 1e-3F);
  EXPECT_NEAR(ColumnPath(*fields, 0, 0, 0), 1e-3 * kDensity_kg_per_m3 * 3000.0, 1e-4);
  EXPECT_NEAR(ColumnPath(*fields, 0, 1, 0), 1e-3 * kDensity_kg_per_m3 * 500.0, 1e-4);
  for (const float mass : fields->fields[0].concentration_kg_per_m3) {
    ASSERT_TRUE(mass >= 0.0F && mass < 1.0F) << mass;
  }
}

TEST_F(WrfReader, RefusesInfiniteAmounts) {
  for (const double sign : {1.0, -1.0}) {
    SyntheticWrf file = Uniform(1e-3);
    file.stored_values = {{"QCLOUD", {1, 0, 1, 0}, sign * std::numeric_limits<double>::infinity()}};
    const auto fields = Read(file);
    EXPECT_EQ(fields.status().code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(std::string(fields.status().message()),
                ::testing::HasSubstr("QCLOUD holds the value"));
  }
}

TEST_F(WrfReader, TakesCellsWithoutAirAsMissing) {
  SyntheticWrf file = Uniform(1e-3);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  file.stored_values = {
      {"T", {0, 0, 1, 0}, kNan},       // one cell
      {"P", {1, 0, 2, 0}, 1e35},       // one cell
      {"QVAPOR", {2, 0, 3, 0}, kNan},  // one cell
      {"PH", {3, 0, 4, 0}, 9.969e36},  // an interface: the layers on both its sides
  };
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ(fields->fields[0].statistics.missing_cells, 5);
  const double layer = 1e-3 * kDensity_kg_per_m3 * 500.0;
  EXPECT_NEAR(ColumnPath(*fields, 0, 0, 0), 7 * layer, 1e-4);
  EXPECT_NEAR(ColumnPath(*fields, 0, 3, 0), 6 * layer, 1e-4);
  EXPECT_NEAR(ColumnPath(*fields, 0, 3, 1), 8 * layer, 1e-4);
}

// The top layer contains all the mass. The mass must not be lost when the layers of a later time
// rise above the storm's grid.
TEST_F(WrfReader, AddsCellsForCondensateAboveTheStormsGrid) {
  SyntheticWrf file;
  file.mixing_ratios["QICE"] = [](const WrfCell& cell) { return cell.level == 7 ? 1e-3 : 0.0; };
  const VerticalGrid grid{0.0, 500.0, 7};
  const auto fields = Read(file, 0, grid);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ(fields->grid.cells.z, 8);
  EXPECT_NEAR(ColumnPath(*fields, 0, 0, 0), 1e-3 * kDensity_kg_per_m3 * 500.0, 1e-4);
}

TEST_F(WrfReader, KeepsTheStormsGridWhereOnlyClearAirRisesAboveIt) {
  SyntheticWrf file;
  file.mixing_ratios["QICE"] = [](const WrfCell& cell) { return cell.level == 3 ? 1e-3 : 0.0; };
  const VerticalGrid grid{0.0, 500.0, 7};
  const auto fields = Read(file, 0, grid);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ(fields->grid.cells.z, 7);
  EXPECT_EQ(fields->fields[0].concentration_kg_per_m3.size(), fields->grid.CellCount());
  EXPECT_NEAR(ColumnPath(*fields, 0, 0, 0), 1e-3 * kDensity_kg_per_m3 * 500.0, 1e-4);
}

TEST_F(WrfReader, RefusesHeightsOfAnotherRun) {
  const auto fields = Read(Uniform(1e-3), 0, VerticalGrid{0.0, 10.0, 7});
  EXPECT_EQ(fields.status().code(), absl::StatusCode::kDataLoss);
  EXPECT_THAT(std::string(fields.status().message()), ::testing::HasSubstr("PH + PHB"));
}

TEST_F(WrfReader, ReadsASingleLayer) {
  SyntheticWrf file = Uniform(1e-3);
  file.levels = 1;
  file.nx = 1;
  file.ny = 1;
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ(fields->grid.cells, glm::ivec3(1, 1, 1));
  EXPECT_NEAR(ColumnPath(*fields, 0, 0, 0), 1e-3 * kDensity_kg_per_m3 * 4000.0, 1e-3);
}

TEST_F(WrfReader, EndsWhereItsCallerSaysSo) {
  const std::string path = folder_.File("wrfout");
  testing::WriteWrf(Uniform(1e-3), path);
  const auto metadata = ReadWrfMetadata(path);
  ASSERT_TRUE(metadata.ok()) << metadata.status();
  int calls = 0;
  const auto fields = ReadWrfTime(*metadata, 0, std::nullopt, [&](double) {
    return ++calls == 4 ? absl::CancelledError("enough") : absl::OkStatus();
  });
  EXPECT_EQ(fields.status().code(), absl::StatusCode::kCancelled);
  EXPECT_EQ(calls, 4);
}

TEST_F(WrfReader, TakesTimesFromXtimeWhereTimesAreLeftOut) {
  const std::string path = folder_.File("wrfout");
  SyntheticWrf file = Uniform(1e-3);
  file.omitted = {"Times"};
  file.minutes = {90.5};
  const auto first = [&](const std::string& units) {
    file.units["XTIME"] = units;
    testing::WriteWrf(file, path);
    const auto metadata = ReadWrfMetadata(path);
    EXPECT_TRUE(metadata.ok()) << metadata.status();
    return metadata.ok() ? absl::FormatTime(metadata->times.at(0), absl::UTCTimeZone()) : "";
  };
  EXPECT_EQ(first(""), "2013-05-20T13:30:30+00:00");
  EXPECT_EQ(first("minutes"), "2013-05-20T13:30:30+00:00");
  EXPECT_EQ(first("minutes since 2013-05-20 18:00:00"), "2013-05-20T19:30:30+00:00");
  EXPECT_EQ(first("hours since 2013-05-20 18:00:00"), "2013-05-24T12:30:00+00:00");
}

TEST_F(WrfReader, LeavesOutWhatIsInOtherUnits) {
  SyntheticWrf file = Uniform(1e-3);
  file.mixing_ratios["TKE"] = [](const WrfCell&) { return 0.25; };
  file.units["TKE"] = "m2 s-2";
  auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ(fields->motion.source, volume::TurbulenceSource::kEnergy);
  file.units["TKE"] = "kg";
  const testing::CapturedLog log;
  fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ(fields->motion.source, volume::TurbulenceSource::kGradient);
  EXPECT_THAT(log.Text(), ::testing::HasSubstr("TKE has units 'kg' where 'm2 s-2' is needed"));
  file.units["XLAT"] = "radian";
  const std::string path = folder_.File("wrfout");
  testing::WriteWrf(file, path);
  const auto metadata = ReadWrfMetadata(path);
  ASSERT_TRUE(metadata.ok()) << metadata.status();
  EXPECT_FALSE(metadata->place.middle.has_value());
  EXPECT_THAT(log.Text(), ::testing::HasSubstr("XLAT has units 'radian'"));
}

}  // namespace
}  // namespace thunderhead::storm_files
