// Tests of reading a window of a storm, and of averaging blocks of its columns.
#include "storm_files/record_part.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "storm_files/storm_format.h"
#include "tests/support/earth_formulas.h"
#include "tests/support/synthetic_wrf.h"
#include "tests/support/temporary_folder.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::storm_files {
namespace {

using ::testing::HasSubstr;
using testing::WrfCell;
using volume::HydrometeorFields;

RecordPart Part(const ColumnWindow& window, int stride = 1) {
  RecordPart part;
  part.window = window;
  part.stride = stride;
  return part;
}

// Returns the concentration of a field in a cell; a field without condensate has no array.
float At(const HydrometeorFields& fields, std::size_t field, const glm::ivec3& cell) {
  const auto& values = fields.fields[field].concentration_kg_per_m3;
  return values.empty() ? 0.0F : values[fields.grid.Offset(cell.x, cell.y, cell.z)];
}

// Returns the mass of all condensate.
double Mass_kg(const HydrometeorFields& fields) {
  double sum = 0.0;
  for (const auto& field : fields.fields) {
    for (const float value : field.concentration_kg_per_m3) sum += value;
  }
  const glm::dvec3 cell_m = fields.grid.spacing_m;
  return sum * cell_m.x * cell_m.y * cell_m.z;
}

class RecordPartTest : public ::testing::Test {
 protected:
  void Describe(const std::string& path) {
    auto file = StormFormats::BuiltIn().Describe(path);
    ASSERT_TRUE(file.ok()) << file.status();
    file_ = *std::move(file);
    const auto grid = file_.reader->ReadVerticalGrid(0);
    ASSERT_TRUE(grid.ok()) << grid.status();
    grid_ = *grid;
    whole_ = Read({});
  }

  // A nest whose columns are resampled, because the map factor is about 1.1.
  void DescribeNest() {
    testing::SyntheticWrf file;
    file.nx = 48;
    file.ny = 40;
    file.levels = 3;
    file.dx_m = file.dy_m = 10'000.0;
    file.map_projection = 3;
    file.numbers = {{"TRUELAT1", 0.0}, {"STAND_LON", -89.0}};
    const auto place = [](const WrfCell& cell) {
      return testing::FromMercator({1e4 * cell.x - 290e3, 1e4 * cell.y + 2.49e6}, 0.0, -89.0);
    };
    file.columns["XLAT"] = [=](const WrfCell& cell) { return place(cell).latitude_deg; };
    file.columns["XLONG"] = [=](const WrfCell& cell) { return place(cell).longitude_deg; };
    file.mixing_ratios["QCLOUD"] = [](const WrfCell& cell) {
      return 1e-4 * (1.0 + 0.5 * std::sin(0.3 * cell.x) * std::cos(0.2 * cell.y));
    };
    const std::string path = folder_.File("wrfout");
    testing::WriteWrf(file, path);
    Describe(path);
  }

  HydrometeorFields Read(const RecordPart& part) const {
    auto fields = file_.reader->Read(part, grid_, {});
    EXPECT_TRUE(fields.ok()) << fields.status();
    return fields.ok() ? *std::move(fields) : HydrometeorFields();
  }

  // Expects that the window has the values of the whole domain, at the same places.
  void ExpectWindow(const ColumnWindow& window, double tolerance) const {
    const HydrometeorFields part = Read(Part(window));
    ASSERT_EQ(glm::ivec2(part.grid.cells), window.columns);
    EXPECT_EQ(part.grid.spacing_m, whole_.grid.spacing_m);
    for (int axis = 0; axis < 2; ++axis) {
      EXPECT_NEAR(part.grid.low_corner_m[axis],
                  whole_.grid.low_corner_m[axis] + window.low[axis] * whole_.grid.spacing_m[axis],
                  1e-6);
    }
    ASSERT_EQ(part.fields.size(), whole_.fields.size());
    double largest = 0.0;
    for (int z = 0; z < part.grid.cells.z; ++z) {
      for (int y = 0; y < window.columns.y; ++y) {
        for (int x = 0; x < window.columns.x; ++x) {
          for (std::size_t field = 0; field < part.fields.size(); ++field) {
            const float expected = At(whole_, field, {window.low.x + x, window.low.y + y, z});
            largest = std::max(largest, static_cast<double>(expected));
            ASSERT_NEAR(At(part, field, {x, y, z}), expected, tolerance * expected)
                << x << ", " << y << ", " << z;
          }
        }
      }
    }
    EXPECT_GT(largest, 0.0) << "the window has no cloud, so nothing was compared";
    for (int y = 0; y < window.columns.y; ++y) {
      for (int x = 0; x < window.columns.x; ++x) {
        const auto at = static_cast<std::size_t>(y * window.columns.x + x);
        const auto in_whole =
            static_cast<std::size_t>((window.low.y + y) * whole_.grid.cells.x + window.low.x + x);
        ASSERT_FLOAT_EQ(part.terrain_height_m[at], whole_.terrain_height_m[in_whole]);
      }
    }
  }

  testing::TemporaryFolder folder_;
  StormFile file_;
  VerticalGrid grid_;
  HydrometeorFields whole_;
};

TEST_F(RecordPartTest, AWindowHasTheValuesOfTheWholeDomain) {
  Describe(THUNDERHEAD_SOURCE_DIR "/samples/supercell.nc");
  const glm::ivec2 middle = glm::ivec2(whole_.grid.cells) / 2;
  ExpectWindow({middle - glm::ivec2(6, 4), {11, 9}}, 0.0);
  ExpectWindow({{0, 0}, glm::ivec2(whole_.grid.cells)}, 0.0);
}

// The tolerance is the factor by which the whole domain's values are multiplied so that resampling
// keeps their sum. A window has no such factor.
TEST_F(RecordPartTest, AWindowOfResampledColumnsHasTheValuesOfTheWholeDomain) {
  DescribeNest();
  ExpectWindow({{5, 9}, {17, 12}}, 0.01);
  ExpectWindow({glm::ivec2(whole_.grid.cells) - glm::ivec2(9, 7), {9, 7}}, 0.01);
}

// The nest has cloud up to its edges, beyond which the last blocks reach.
TEST_F(RecordPartTest, BlocksOfColumnsKeepTheirMass) {
  DescribeNest();
  for (const int stride : {2, 3, 7}) {
    RecordPart part;
    part.stride = stride;
    const HydrometeorFields coarse = Read(part);
    const glm::ivec2 columns(whole_.grid.cells);
    EXPECT_EQ(glm::ivec2(coarse.grid.cells), (columns + stride - 1) / stride);
    EXPECT_EQ(coarse.grid.spacing_m.x, stride * whole_.grid.spacing_m.x);
    EXPECT_EQ(coarse.grid.low_corner_m.x, whole_.grid.low_corner_m.x);
    EXPECT_NEAR(Mass_kg(coarse) / Mass_kg(whole_), 1.0, 1e-5) << "stride " << stride;
  }
}

TEST_F(RecordPartTest, ABlockIsTheMeanOfItsColumns) {
  DescribeNest();
  const HydrometeorFields fine = Read(Part({{4, 6}, {12, 10}}));
  const HydrometeorFields coarse = Read(Part({{4, 6}, {12, 10}}, 2));
  ASSERT_EQ(glm::ivec2(coarse.grid.cells), glm::ivec2(6, 5));
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 6; ++x) {
      const auto at = [&](int dx, int dy) { return At(fine, 0, {2 * x + dx, 2 * y + dy, 1}); };
      const float mean = 0.25F * (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1));
      EXPECT_NEAR(At(coarse, 0, {x, y, 1}), mean, 1e-5F * mean);
    }
  }
}

TEST_F(RecordPartTest, APartThatTheStormDoesNotHaveIsRefused) {
  Describe(THUNDERHEAD_SOURCE_DIR "/samples/supercell.nc");
  const glm::ivec2 columns(whole_.grid.cells);
  const auto refusal = [&](const RecordPart& part) {
    const auto fields = file_.reader->Read(part, grid_, {});
    EXPECT_EQ(fields.status().code(), absl::StatusCode::kInvalidArgument);
    return std::string(fields.status().message());
  };
  constexpr int kMost = std::numeric_limits<int>::max();
  EXPECT_THAT(refusal(Part({{-1, 0}, {2, 2}})), HasSubstr("not within the storm"));
  EXPECT_THAT(refusal(Part({{0, 0}, {0, 2}})), HasSubstr("is empty"));
  EXPECT_THAT(refusal(Part({{0, 1}, columns})), HasSubstr("not within the storm"));
  EXPECT_THAT(refusal(Part({{kMost, 0}, {2, 2}})), HasSubstr("not within the storm"));
  EXPECT_THAT(refusal(Part({{1, 0}, {kMost, 2}})), HasSubstr("not within the storm"));
  EXPECT_THAT(refusal(Part({{0, 0}, {2, 2}}, 0)), HasSubstr("a stride of 0 columns"));
  EXPECT_THAT(refusal(Part({{0, 0}, {2, 2}}, kMost)), HasSubstr("give 1 to"));
}

}  // namespace
}  // namespace thunderhead::storm_files
