// Tests of Gaussian grids (template 3.40), regular and reduced. The expected latitudes come from
// ecCodes, which the reader does not use for them.
#include <eccodes.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>

#include "absl/strings/str_format.h"
#include "glm/geometric.hpp"
#include "grib/gaussian.h"
#include "storm_files/even_columns.h"
#include "storm_files/grib_columns.h"
#include "storm_files/storm_format.h"
#include "tests/support/earth_formulas.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/grib/messages.h"
#include "volume/map_projection.h"

namespace thunderhead::grib::gaussian_test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using testing::Number;

constexpr std::int64_t kMissing = 0xFFFFFFFF;
constexpr double kRadius_m = 6'371'229.0;

const std::vector<double>& LatitudesOfEccodes(int parallels) {
  static std::map<int, std::vector<double>> all;
  std::vector<double>& latitudes = all[parallels];
  if (!latitudes.empty()) return latitudes;
  latitudes.resize(2U * static_cast<std::size_t>(parallels));
  EXPECT_EQ(codes_get_gaussian_latitudes(parallels, latitudes.data()), CODES_SUCCESS);
  return latitudes;
}

std::int64_t Micro(double degrees) { return std::llround(degrees * 1e6); }

// Section 3 of a part of a Gaussian grid. `around` has for each row the number of points on its
// full circle. It is empty for a regular grid.
struct Gaussian {
  int parallels = 640;
  int first_row = 265;  // 52.7 N
  int rows = 40;
  int columns = 60;  // of a regular grid
  double west_deg = 5.0;
  double east_deg = 0.0;
  std::vector<int> around;
  int scanning = 0;

  // A regular grid has as many points on a circle as 4 times its parallels.
  double Step_deg() const { return 90.0 / parallels; }
  double East_deg() const {
    return around.empty() ? west_deg + (columns - 1) * Step_deg() : east_deg;
  }

  // Returns the places of the points, in the file's order.
  std::vector<volume::EarthPlace> Places() const {
    const std::vector<double>& latitudes = LatitudesOfEccodes(parallels);
    std::vector<volume::EarthPlace> places;
    for (int i = 0; i < rows; ++i) {
      const int row = scanning == 0 ? first_row + i : first_row + rows - 1 - i;
      const int count = around.empty() ? columns : around[static_cast<std::size_t>(i)];
      for (int k = 0; k < 2 * count; ++k) {
        const double longitude_deg = around.empty() ? west_deg + k * Step_deg() : k * 360.0 / count;
        if (longitude_deg < west_deg - 1e-9 || longitude_deg > East_deg() + 1e-9) continue;
        places.push_back({latitudes[static_cast<std::size_t>(row)], longitude_deg});
      }
    }
    return places;
  }

  // Returns the distance in longitude from a point to the next.
  double StepAt_deg(const volume::EarthPlace& place) const {
    if (around.empty()) return Step_deg();
    const std::vector<double>& latitudes = LatitudesOfEccodes(parallels);
    const auto row = std::ranges::find(latitudes, place.latitude_deg) - latitudes.begin();
    return 360.0 / around[static_cast<std::size_t>(row - first_row)];
  }

  std::string Section3(std::int64_t points) const {
    const std::vector<double>& latitudes = LatitudesOfEccodes(parallels);
    const double north_deg = latitudes[static_cast<std::size_t>(first_row)];
    const double south_deg = latitudes[static_cast<std::size_t>(first_row + rows - 1)];
    const bool is_reduced = !around.empty();
    std::string text =
        Number(0, 1) + Number(points, 4) + Number(is_reduced ? 2 : 0, 1) +
        Number(is_reduced ? 1 : 0, 1) + Number(40, 2) + Number(6, 1) + Number(0, 15) +
        Number(is_reduced ? kMissing : columns, 4) + Number(rows, 4) + Number(0, 4) +
        Number(kMissing, 4) + Number(Micro(scanning == 0 ? north_deg : south_deg), 4) +
        Number(Micro(west_deg), 4) + Number(0x30, 1) +
        Number(Micro(scanning == 0 ? south_deg : north_deg), 4) + Number(Micro(East_deg()), 4) +
        Number(is_reduced ? kMissing : Micro(Step_deg()), 4) + Number(parallels, 4) +
        Number(scanning, 1);
    for (const int count : around) text += Number(count, 2);
    return text;
  }
  std::string Section3() const { return Section3(static_cast<std::int64_t>(Places().size())); }
};

// Returns the number of points in each of `rows` rows of the octahedral grid with `parallels`
// parallels between a pole and the equator, from the row `first` on.
std::vector<int> Octahedral(int parallels, int first, int rows) {
  std::vector<int> around;
  for (int i = first; i < first + rows; ++i) {
    around.push_back(20 + 4 * std::min(i, 2 * parallels - 1 - i));
  }
  return around;
}

// Returns the octahedral grid O32, all around the Earth.
Gaussian GlobalOctahedral() {
  Gaussian whole;
  whole.parallels = 32;
  whole.first_row = 0;
  whole.rows = 64;
  whole.around = Octahedral(32, 0, 64);
  whole.west_deg = 0.0;
  whole.east_deg = 360.0 - 360.0 / 144.0;
  return whole;
}

Gaussian Reduced() {
  Gaussian grid;
  grid.around = Octahedral(grid.parallels, grid.first_row, grid.rows);
  grid.east_deg = 14.0;
  return grid;
}

absl::StatusOr<Grid> Read(const std::string& contents) {
  const std::string section = testing::Section(3, contents);
  return ReadGrid(std::as_bytes(std::span(section)));
}

std::string ErrorOf(const std::string& contents) {
  return std::string(Read(contents).status().message());
}

TEST(GaussianLatitudes, AreThoseOfEccodes) {
  for (const int parallels : {1, 2, 7, 48, 320, 1280}) {
    const std::vector<double>& expected = LatitudesOfEccodes(parallels);
    const std::vector<double> latitudes = GaussianLatitudes_deg(parallels, 0, 2 * parallels);
    ASSERT_EQ(latitudes.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      ASSERT_NEAR(latitudes[i], expected[i], 1e-9) << parallels << " " << i;
    }
  }
}

TEST(GaussianGrid, RowsAreAtTheirLatitudes) {
  for (const int scanning : {0x00, 0x40}) {
    Gaussian layout;
    layout.scanning = scanning;
    const auto grid = Read(layout.Section3());
    ASSERT_TRUE(grid.ok()) << grid.status();
    EXPECT_EQ(grid->columns, 60);
    EXPECT_EQ(grid->rows, 40);
    EXPECT_NEAR(grid->south_west.x, 5.0, 1e-9);
    EXPECT_NEAR(grid->step.x, 0.140625, 1e-6);
    const std::vector<double>& latitudes = LatitudesOfEccodes(640);
    for (int row = 0; row < 40; ++row) {
      EXPECT_NEAR(grid->south_west.y + row * grid->step.y, latitudes[304U - row],
                  0.002 * grid->step.y);
    }
    EXPECT_TRUE(grid->assumptions.empty());
  }
}

// Latitudes that are treated as evenly spaced are least accurate near a pole. The reader must state
// the largest error.
TEST(GaussianGrid, TheLargestErrorOfRowsIsStated) {
  Gaussian layout;
  layout.parallels = 32;
  layout.first_row = 0;
  layout.rows = 64;
  layout.columns = 128;
  layout.west_deg = 0.0;
  const auto grid = Read(layout.Section3());
  ASSERT_TRUE(grid.ok()) << grid.status();
  const std::vector<double>& latitudes = LatitudesOfEccodes(32);
  double largest = 0.0;
  for (int row = 0; row < 64; ++row) {
    const double error_deg =
        std::abs(grid->south_west.y + row * grid->step.y - latitudes[63U - row]);
    largest = std::max(largest, error_deg / grid->step.y);
  }
  EXPECT_LT(largest, 0.02);
  EXPECT_THAT(grid->assumptions, Contains(absl::StrFormat(
                                     "The grid's Gaussian latitudes are treated as evenly spaced, "
                                     "which moves rows by at most %.1f %% of their distance.",
                                     100.0 * largest)));
  // All longitudes are there, so the domain is wider than a hemisphere.
  const auto even = storm_files::MakeEven(storm_files::PlacesOf(*grid));
  ASSERT_TRUE(even.ok()) << even.status();
  EXPECT_EQ(even->columns, glm::ivec2(128, 64));
}

TEST(GaussianGrid, ContradictionsAreNamed) {
  const std::string good = Gaussian().Section3();
  const auto with = [&good](std::size_t octet, const std::string& bytes) {
    std::string text = good;
    return text.replace(octet - 6, bytes.size(), bytes);
  };
  EXPECT_THAT(ErrorOf(with(68, Number(640, 4))), "");
  EXPECT_THAT(ErrorOf(with(68, Number(639, 4))),
              HasSubstr("which no Gaussian grid of 639 parallels has"));
  EXPECT_THAT(ErrorOf(with(68, Number(0, 4))), HasSubstr("without a number of parallels"));
  EXPECT_THAT(ErrorOf(with(68, Number(5000, 4))), HasSubstr("more than 4000"));
  EXPECT_THAT(ErrorOf(with(72, Number(0x40, 1))),
              HasSubstr("rows whose direction contradicts its first and last latitude"));
  Gaussian fewer;
  fewer.rows = 39;
  std::string rows = Gaussian().Section3();
  rows.replace(56 - 6, 4, fewer.Section3().substr(56 - 6, 4));
  EXPECT_THAT(ErrorOf(rows), HasSubstr("has 40 rows, but its first and last latitude say 39"));
  EXPECT_THAT(ErrorOf(good.substr(0, 60)), HasSubstr("too few numbers"));
}

TEST(ReducedGaussianGrid, RowsHaveTheirOwnPoints) {
  const Gaussian layout = Reduced();
  const auto grid = Read(layout.Section3());
  ASSERT_TRUE(grid.ok()) << grid.status();
  EXPECT_TRUE(grid->IsUnstructured());
  EXPECT_EQ(grid->cells, "reduced Gaussian grid N640");
  const std::vector<volume::EarthPlace> places = layout.Places();
  ASSERT_EQ(grid->Points(), places.size());
  std::size_t at = 0;
  for (const CellRow& row : grid->cell_rows) {
    for (int i = 0; i < row.cells; ++i, ++at) {
      EXPECT_NEAR(row.latitude_deg, places[at].latitude_deg, 1e-9);
      EXPECT_NEAR(row.first_longitude_deg + i * row.step_deg, places[at].longitude_deg, 1e-9);
    }
  }
  EXPECT_EQ(at, places.size());
}

TEST(ReducedGaussianGrid, EdgesMayCrossGreenwichAndBeRounded) {
  Gaussian layout = Reduced();
  layout.west_deg = 352.0;
  layout.east_deg = 366.0;
  const auto points = static_cast<std::int64_t>(layout.Places().size());
  std::string text = layout.Section3(points);
  text.replace(60 - 6, 4, Number(6'000'000, 4));
  const auto grid = Read(text);
  ASSERT_TRUE(grid.ok()) << grid.status();
  EXPECT_EQ(grid->Points(), layout.Places().size());
  // The longitude of the last column may be in millidegrees, as in files that were converted from
  // GRIB1.
  Gaussian whole = GlobalOctahedral();
  EXPECT_TRUE(Read(whole.Section3()).ok());
  whole.around.assign(64, 131);
  whole.east_deg = 360.0 - 360.0 / 131.0;
  text = whole.Section3();
  text.replace(60 - 6, 4, Number(357'252'000, 4));  // rounded from 357 251 908
  EXPECT_TRUE(Read(text).ok()) << Read(text).status();
  text.replace(60 - 6, 4, Number(357'251'000, 4));
  EXPECT_TRUE(Read(text).ok()) << Read(text).status();
}

TEST(ReducedGaussianGrid, ContradictionsAreNamed) {
  const Gaussian layout = Reduced();
  const std::string good = layout.Section3();
  const auto with = [&good](std::size_t octet, const std::string& bytes) {
    std::string text = good;
    return text.replace(octet - 6, bytes.size(), bytes);
  };
  const auto points = static_cast<std::int64_t>(layout.Places().size());
  EXPECT_THAT(ErrorOf(layout.Section3(points - 1)),
              HasSubstr("which is not the number in its rows"));
  EXPECT_THAT(ErrorOf(with(12, Number(2, 1))), HasSubstr("not described as full circles"));
  EXPECT_THAT(ErrorOf(with(15, Number(5, 1))), HasSubstr("other than a sphere of 6371229 m"));
  EXPECT_THAT(ErrorOf(with(72, Number(0x80, 1))), HasSubstr("do not all run eastwards"));
  EXPECT_THAT(ErrorOf(good.substr(0, good.size() - 2)), HasSubstr("incomplete list"));
  EXPECT_THAT(ErrorOf(with(73, Number(0, 2))), HasSubstr("has 0 points in a row"));
}

// A storm of HRRR's layout with four levels, on any grid, whose cloud is a blob.
class GaussianStorm : public ::testing::Test {
 protected:
  absl::StatusOr<storm_files::StormFile> Describe(const Gaussian& layout,
                                                  const std::vector<float>& cloud,
                                                  const std::string& temperature_grid = "") {
    std::string bytes;
    for (int level = 1; level <= 4; ++level) {
      const auto height_m = static_cast<float>(1000 * level);
      const auto add = [&](int category, int number, std::vector<float> values, float step = 1.0F) {
        testing::Message message;
        message.category = category;
        message.number = number;
        message.level = {105, level};
        const bool is_moved = category == 0 && !temperature_grid.empty();
        message.grid = is_moved ? temperature_grid : layout.Section3();
        message.points = static_cast<std::int64_t>(cloud.size());
        message.values = std::move(values);
        message.step = step;
        bytes += testing::BytesOf(message);
      };
      add(3, 5, {height_m});
      add(3, 0, {100'000.0F - 10.0F * height_m});
      add(0, 0, {280.0F});
      add(1, 0, {0.0F});
      add(1, 22, cloud, std::exp2(-22.0F));
    }
    const std::string path = folder_.File("gaussian.grib2");
    std::ofstream(path, std::ios::binary) << bytes;
    return storm_files::StormFormats::BuiltIn().Describe(path);
  }

  // Expects a blob of 60 km at its place, with its mass and largest value.
  void ExpectBlob(const Gaussian& layout, double tolerance_rows) {
    const volume::EarthPlace core{50.3, 9.2};
    constexpr double kWidth_m = 60e3;
    std::vector<float> cloud;
    double mass = 0.0;
    const double row_m =
        kRadius_m * std::numbers::pi / 180.0 * 180.0 / (2 * layout.parallels + 0.5);
    for (const volume::EarthPlace& place : layout.Places()) {
      const double distance = thunderhead::testing::Distance_m(place, core) / kWidth_m;
      cloud.push_back(static_cast<float>(1e-3 * std::exp(-distance * distance)));
      const double across_m = kRadius_m * std::numbers::pi / 180.0 *
                              std::cos(glm::radians(place.latitude_deg)) * layout.StepAt_deg(place);
      mass += cloud.back() * across_m * row_m;
    }
    const auto file = Describe(layout, cloud);
    ASSERT_TRUE(file.ok()) << file.status();
    const auto fields = file->reader->Read(0, std::nullopt, {});
    ASSERT_TRUE(fields.ok()) << fields.status();
    const volume::RegularGrid& grid = fields->grid;
    const auto path = [&](std::size_t column) {
      double sum = 0.0;
      for (int z = 0; z < grid.cells.z; ++z) {
        const auto level = static_cast<std::size_t>(z);
        sum +=
            fields->fields[0].concentration_kg_per_m3[level * grid.cells.x * grid.cells.y + column];
      }
      return sum * grid.spacing_m.z;
    };
    const auto columns = static_cast<std::size_t>(grid.cells.x) * grid.cells.y;
    double sum = 0.0;
    double largest = 0.0;
    glm::dvec2 centroid(0.0);
    for (std::size_t i = 0; i < columns; ++i) {
      const double water = path(i);
      sum += water;
      centroid += water * glm::dvec2(i % grid.cells.x, i / grid.cells.x);
      largest = std::max(largest, water);
    }
    // Layers of 1 km at 900 to 600 hPa and 280 K.
    constexpr double kAir_kg_per_m2 = 300'000.0 * 1000.0 / (287.0 * 280.0);
    const double highest = *std::ranges::max_element(cloud);
    EXPECT_NEAR(largest / (highest * kAir_kg_per_m2), 1.0, 0.02);
    EXPECT_NEAR(sum * grid.spacing_m.x * grid.spacing_m.y / (mass * kAir_kg_per_m2), 1.0, 0.01);
    const auto map =
        volume::MapProjection::Of(file->projection, {*file->latitude_deg, *file->longitude_deg});
    ASSERT_TRUE(map.ok()) << map.status();
    const auto found = map->PlaceOf((centroid / sum + 0.5 - 0.5 * glm::dvec2(grid.cells)) *
                                    glm::dvec2(grid.spacing_m));
    ASSERT_TRUE(found.has_value());
    EXPECT_LT(thunderhead::testing::Distance_m(*found, core), tolerance_rows * row_m);
    assumptions_ = file->assumptions;
  }

  thunderhead::testing::TemporaryFolder folder_;
  std::vector<std::string> assumptions_;
};

TEST_F(GaussianStorm, ARegularGridIsReadInItsPlace) {
  for (const int scanning : {0x00, 0x40}) {
    Gaussian layout;
    layout.scanning = scanning;
    ExpectBlob(layout, 0.25);
    EXPECT_THAT(assumptions_, Contains(HasSubstr("resampled to even distances")));
  }
}

TEST_F(GaussianStorm, AReducedGridIsReadByItsCells) {
  ExpectBlob(Reduced(), 0.5);
  EXPECT_THAT(assumptions_, Contains(HasSubstr("values of the nearest cell")));
}

TEST_F(GaussianStorm, AGlobalReducedGridNamesTheRemedy) {
  const Gaussian whole = GlobalOctahedral();
  const auto file = Describe(whole, std::vector<float>(whole.Places().size(), 0.0F));
  ASSERT_FALSE(file.ok());
  EXPECT_THAT(std::string(file.status().message()),
              HasSubstr("the cells lie all around the Earth; cut a region first"));
}

// Archives of IFS have the temperature of model levels as spherical harmonics.
TEST_F(GaussianStorm, SpectralTemperatureIsNamed) {
  Gaussian layout;
  const std::vector<float> cloud(layout.Places().size(), 0x1p-20F);
  const std::string spectral = Number(0, 1) + Number(static_cast<std::int64_t>(cloud.size()), 4) +
                               Number(0, 2) + Number(50, 2) + Number(639, 4) + Number(639, 4) +
                               Number(639, 4) + Number(1, 1) + Number(1, 1);
  const auto file = Describe(layout, cloud, spectral);
  ASSERT_FALSE(file.ok());
  EXPECT_THAT(std::string(file.status().message()),
              ::testing::AllOf(HasSubstr("on another grid than the hydrometeors"),
                               HasSubstr("spherical harmonics"), HasSubstr("cdo sp2gpl")));
}

}  // namespace
}  // namespace thunderhead::grib::gaussian_test
