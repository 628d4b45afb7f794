// Tests of places and distances of GRIB grids of real size, against formulas. Their fields have few
// values.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <string>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "glm/geometric.hpp"
#include "glm/trigonometric.hpp"
#include "storm_files/storm_format.h"
#include "tests/support/earth_formulas.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/grib/messages.h"
#include "volume/map_projection.h"

namespace thunderhead::storm_files {
namespace {

using grib::testing::BytesOf;
using grib::testing::Message;
using grib::testing::Number;
using testing::Distance_m;
using testing::LambertFormulas;
using volume::EarthPlace;

constexpr double kRadius_m = 6'371'229.0;
// The formulas are for a sphere of another radius.
constexpr double kOfFormulas = testing::kEarth_m / kRadius_m;

// A grid of a weather centre, and the place of each of its columns by formulas.
struct Domain {
  glm::ivec2 columns{0};
  std::string grid;  // section 3
  std::function<EarthPlace(const glm::dvec2& column)> place_of;

  glm::dvec2 Middle() const { return 0.5 * glm::dvec2(columns - 1); }
  double TrueLength_m(const glm::dvec2& from, const glm::dvec2& to) const {
    return Distance_m(place_of(from), place_of(to)) / kOfFormulas;
  }
  // Corners, the middles of the sides, and the middle.
  std::vector<glm::ivec2> Samples() const {
    std::vector<glm::ivec2> samples;
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) samples.push_back((columns - 1) * glm::ivec2(i, j) / 2);
    }
    return samples;
  }
};

std::string Micro(double degrees) { return Number(std::llround(degrees * 1e6), 4); }
std::string Milli(double metres) { return Number(std::llround(metres * 1e3), 4); }

// Returns the beginning of section 3, up to the number of rows.
std::string Begin(const glm::ivec2& columns, int number) {
  return Number(0, 1) + Number(std::int64_t{columns.x} * columns.y, 4) + Number(0, 2) +
         Number(number, 2) + Number(6, 1) + Number(0, 15) + Number(columns.x, 4) +
         Number(columns.y, 4);
}

// Returns a grid on HRRR's map: Lambert, tangent at 38.5 N.
Domain Hrrr(const glm::ivec2& columns, const glm::dvec2& step_m, const EarthPlace& first) {
  Domain domain;
  domain.columns = columns;
  domain.grid = Begin(columns, 30) + Micro(first.latitude_deg) + Micro(first.longitude_deg) +
                Number(0x08, 1) + Micro(38.5) + Micro(262.5) + Milli(step_m.x) + Milli(step_m.y) +
                Number(0, 1) + Number(0x40, 1) + Micro(38.5) + Micro(38.5) + Micro(-90.0) +
                Number(0, 4);
  const LambertFormulas lambert(38.5, 38.5, -97.5);
  domain.place_of = [=](const glm::dvec2& column) {
    return lambert.PlaceOf(lambert.PlaneOf(first) + column * step_m * kOfFormulas);
  };
  return domain;
}

Domain WholeHrrr() { return Hrrr({1799, 1059}, {3000.0, 3000.0}, {21.138123, 237.280472}); }

Domain Degrees(const glm::ivec2& columns, double step_deg, const EarthPlace& first) {
  Domain domain;
  domain.columns = columns;
  const glm::dvec2 last =
      glm::dvec2(first.longitude_deg, first.latitude_deg) + step_deg * glm::dvec2(columns - 1);
  domain.grid = Begin(columns, 0) + Number(0, 8) + Micro(first.latitude_deg) +
                Micro(first.longitude_deg) + Number(0x30, 1) + Micro(last.y) +
                Micro(std::fmod(last.x, 360.0)) + Micro(step_deg) + Micro(step_deg) +
                Number(0x40, 1);
  domain.place_of = [=](const glm::dvec2& column) {
    return EarthPlace{first.latitude_deg + step_deg * column.y,
                      first.longitude_deg + step_deg * column.x};
  };
  return domain;
}

Domain Mercator(const glm::ivec2& columns, double step_m, const EarthPlace& first) {
  Domain domain;
  domain.columns = columns;
  constexpr double kTrue_deg = 20.0;
  domain.grid = Begin(columns, 10) + Micro(first.latitude_deg) + Micro(first.longitude_deg) +
                Number(0x30, 1) + Micro(kTrue_deg) + Micro(first.latitude_deg + 1.0) +
                Micro(first.longitude_deg + 1.0) + Number(0x40, 1) + Number(0, 4) + Milli(step_m) +
                Milli(step_m);
  const double scale_m = testing::kEarth_m * std::cos(glm::radians(kTrue_deg));
  const double north_m = scale_m * std::log(testing::Stretched(glm::radians(first.latitude_deg)));
  domain.place_of = [=](const glm::dvec2& column) {
    return testing::FromMercator(glm::dvec2(0.0, north_m) + column * step_m * kOfFormulas,
                                 kTrue_deg, first.longitude_deg);
  };
  return domain;
}

// Returns a grid on NCEP's polar stereographic map, whose scale is true at 60 N.
Domain Polar(const glm::ivec2& columns, double step_m, const EarthPlace& first) {
  Domain domain;
  domain.columns = columns;
  constexpr double kMeridian_deg = -150.0;
  domain.grid = Begin(columns, 20) + Micro(first.latitude_deg) + Micro(first.longitude_deg) +
                Number(0x08, 1) + Micro(60.0) + Micro(kMeridian_deg) + Milli(step_m) +
                Milli(step_m) + Number(0, 1) + Number(0x40, 1);
  const double from_pole_m = testing::kEarth_m * (1.0 + std::sin(glm::radians(60.0))) *
                             std::tan(glm::radians(45.0 - first.latitude_deg / 2.0));
  const double angle = glm::radians(first.longitude_deg - kMeridian_deg);
  const glm::dvec2 first_m = from_pole_m * glm::dvec2(std::sin(angle), -std::cos(angle));
  domain.place_of = [=](const glm::dvec2& column) {
    return testing::FromPolar(first_m + column * step_m * kOfFormulas, 60.0, kMeridian_deg);
  };
  return domain;
}

// Returns a file in HRRR's layout with two levels. Cloud water is in the columns `cloudy` only, or
// everywhere if `cloudy` is empty.
std::string FileOf(const Domain& domain, const std::vector<glm::ivec2>& cloudy) {
  std::string bytes;
  const auto add = [&](int category, int number, int level, std::vector<float> values, float step) {
    Message message;
    message.category = category;
    message.number = number;
    message.level = {105, level};
    message.grid = domain.grid;
    message.points = std::int64_t{domain.columns.x} * domain.columns.y;
    message.values = std::move(values);
    message.step = step;
    bytes += BytesOf(message);
  };
  const float step = std::exp2(-14.0F);
  std::vector<float> cloud = {8 * step};
  if (!cloudy.empty()) {
    cloud.assign(static_cast<std::size_t>(domain.columns.x) * domain.columns.y, 0.0F);
    for (const glm::ivec2& at : cloudy) {
      cloud[static_cast<std::size_t>(at.y) * domain.columns.x + at.x] = 16 * step;
    }
  }
  for (int level = 1; level <= 2; ++level) {
    const auto height = static_cast<float>(1000 * level);
    add(3, 5, level, {height}, 1.0F);
    add(3, 0, level, {100'000.0F - 10.0F * height}, 1.0F);
    add(0, 0, level, {280.0F}, 1.0F);
    add(1, 0, level, {0.0F}, 1.0F);
    add(1, 22, level, cloud, step);
  }
  return bytes;
}

class GribWide : public ::testing::Test {
 protected:
  StormFile Describe(const Domain& domain, const std::vector<glm::ivec2>& cloudy = {}) {
    const std::string path = folder_.File("wide.grib2");
    std::ofstream(path, std::ios::binary) << FileOf(domain, cloudy);
    auto file = StormFormats::BuiltIn().Describe(path);
    EXPECT_TRUE(file.ok()) << file.status();
    return file.ok() ? *std::move(file) : StormFile();
  }

  testing::TemporaryFolder folder_;
};

volume::MapProjection MapOf(const StormFile& file) {
  auto map = volume::MapProjection::Of(file.projection, {*file.latitude_deg, *file.longitude_deg});
  EXPECT_TRUE(map.ok()) << map.status();
  return *std::move(map);
}

// Returns the world coordinates of a column of the storm.
glm::dvec2 WorldOf(const StormFile& file, const glm::dvec2& column) {
  return (column - 0.5 * glm::dvec2(file.cells.x - 1, file.cells.y - 1)) *
         glm::dvec2(file.dx_m, file.dy_m);
}

// Returns the least and the largest ratio of a length on the storm's map to the true length. The
// lengths are steps of one column of the model, at places all over the domain.
std::pair<double, double> ScalesOn(const StormFile& file, const Domain& domain) {
  const volume::MapProjection map = MapOf(file);
  std::pair<double, double> scales(1.0, 1.0);
  constexpr int kSteps = 40;
  for (int k = 0; k < kSteps * kSteps; ++k) {
    const glm::dvec2 at =
        glm::dvec2(domain.columns - 2) * glm::dvec2(k % kSteps, k / kSteps) / (kSteps - 1.0);
    for (const glm::dvec2 step : {glm::dvec2(1, 0), glm::dvec2(0, 1)}) {
      const auto from = map.WorldOf(domain.place_of(at));
      const auto to = map.WorldOf(domain.place_of(at + step));
      EXPECT_TRUE(from.has_value() && to.has_value());
      const double scale = glm::distance(*from, *to) / domain.TrueLength_m(at, at + step);
      scales = {std::min(scales.first, scale), std::max(scales.second, scale)};
    }
  }
  return scales;
}

// Returns the two percentages of the sentence about distances on the map.
std::pair<double, double> StatedScales(const StormFile& file) {
  for (const std::string& sentence : file.assumptions) {
    const auto at = sentence.find("true in the middle, and ");
    if (at == std::string::npos) continue;
    std::pair<double, double> percent;
    EXPECT_EQ(std::sscanf(sentence.c_str() + at, "true in the middle, and %lf %% to %lf %%",
                          &percent.first, &percent.second),
              2)
        << sentence;
    return {percent.first / 100.0, percent.second / 100.0};
  }
  return {1.0, 1.0};
}

void ExpectStatedScales(const StormFile& file, const Domain& domain) {
  const auto actual = ScalesOn(file, domain);
  const auto stated = StatedScales(file);
  // The statement is a bound, rounded to 0.1 %, and measured up to the edges of columns.
  EXPECT_LE(stated.first, actual.first + 1e-5);
  EXPECT_GE(stated.second, actual.second - 1e-5);
  EXPECT_NEAR(stated.first, actual.first, 0.006);
  EXPECT_NEAR(stated.second, actual.second, 0.006);
}

// The map gives every column the place that the model gives it.
void ExpectPlacesOfColumns(const StormFile& file, const Domain& domain) {
  ASSERT_EQ(glm::ivec2(file.cells), domain.columns);
  const volume::MapProjection map = MapOf(file);
  for (const glm::ivec2& column : domain.Samples()) {
    const auto place = map.PlaceOf(WorldOf(file, column));
    ASSERT_TRUE(place.has_value());
    EXPECT_LT(Distance_m(*place, domain.place_of(column)), 0.02 * file.dx_m)
        << column.x << ", " << column.y;
  }
}

// NCEP states the last point of this grid.
TEST(HrrrFormulas, GiveTheLastPoint) {
  const EarthPlace last = WholeHrrr().place_of({1798, 1058});
  EXPECT_NEAR(last.latitude_deg, 47.842195, 2e-6);
  EXPECT_NEAR(last.longitude_deg, 299.082807 - 360.0, 2e-6);
}

TEST_F(GribWide, PlacesEveryColumnOfHrrr) {
  const Domain hrrr = WholeHrrr();
  const StormFile file = Describe(hrrr);
  ExpectPlacesOfColumns(file, hrrr);
  const glm::dvec2 middle = hrrr.Middle();
  const double true_m = hrrr.TrueLength_m(middle - 0.5, middle + glm::dvec2(0.5, -0.5));
  EXPECT_NEAR(file.dx_m / true_m, 1.0, 1e-4);
  EXPECT_NEAR(file.dy_m / true_m, 1.0, 1e-4);
  ExpectStatedScales(file, hrrr);
  // The scale is 1 at 38.5 N, and largest in the southern corners.
  const LambertFormulas lambert(38.5, 38.5, -97.5);
  const auto stated = StatedScales(file);
  EXPECT_EQ(stated.first, 1.0);
  EXPECT_NEAR(stated.second, lambert.Scale(21.138123), 0.001);
  // The grid's north is off by the longitude times the sine of 38.5 degrees.
  const auto north_deg = MapOf(file).TrueNorth_deg(hrrr.place_of({1798, 0}));
  ASSERT_TRUE(north_deg.has_value());
  const double from_meridian_deg = hrrr.place_of({1798, 0}).longitude_deg + 97.5;
  EXPECT_NEAR(*north_deg, -from_meridian_deg * std::sin(glm::radians(38.5)), 0.01);
}

TEST_F(GribWide, PlacesColumnsOfOtherConformalMaps) {
  for (const Domain& domain :
       {Mercator({450, 300}, 12e3, {-5.0, 110.0}), Polar({450, 400}, 10e3, {40.0, 195.0})}) {
    const StormFile file = Describe(domain);
    ExpectPlacesOfColumns(file, domain);
    ExpectStatedScales(file, domain);
  }
}

// Finds the cloud of each sample in the fields that were read, and expects it at its place.
void ExpectCloudsAtTheirPlaces(const StormFile& file, const Domain& domain,
                               const std::vector<glm::ivec2>& cloudy) {
  const auto fields = file.reader->Read(0, std::nullopt, {});
  ASSERT_TRUE(fields.ok()) << fields.status();
  ASSERT_EQ(glm::ivec2(fields->grid.cells), glm::ivec2(file.cells));
  EXPECT_EQ(fields->grid.spacing_m.x, file.dx_m);
  const volume::MapProjection map = MapOf(file);
  const std::vector<float>& values = fields->fields[0].concentration_kg_per_m3;
  for (const glm::ivec2& column : cloudy) {
    const auto expected_m = map.WorldOf(domain.place_of(column));
    ASSERT_TRUE(expected_m.has_value());
    // Computes the cloud's centre of mass from the cells within two columns of the model.
    const double reach_m =
        2.0 * std::max({file.dx_m, file.dy_m,
                        domain.TrueLength_m(column, glm::dvec2(column) + glm::dvec2(1, 0)),
                        domain.TrueLength_m(column, glm::dvec2(column) + glm::dvec2(0, 1))});
    double mass = 0.0;
    glm::dvec2 moment_m(0.0);
    for (int y = 0; y < file.cells.y; ++y) {
      for (int x = 0; x < file.cells.x; ++x) {
        const glm::dvec2 at_m = WorldOf(file, {x, y});
        if (glm::distance(at_m, *expected_m) > reach_m) continue;
        const double value = values[fields->grid.Offset(x, y, 0)];
        mass += value;
        moment_m += value * at_m;
      }
    }
    ASSERT_GT(mass, 0.0) << column.x << ", " << column.y;
    const glm::dvec2 off = glm::abs(moment_m / mass - *expected_m);
    EXPECT_LT(off.x, 0.6 * file.dx_m) << column.x << ", " << column.y;
    EXPECT_LT(off.y, 0.6 * file.dy_m) << column.x << ", " << column.y;
  }
}

// Every 31st column and every 23rd row of HRRR's grid, in the first and last ones clouds.
TEST_F(GribWide, ReadsCloudsAtTheCornersOfHrrr) {
  const Domain hrrr = Hrrr({59, 47}, {93e3, 69e3}, {21.138123, 237.280472});
  const StormFile file = Describe(hrrr, hrrr.Samples());
  ExpectPlacesOfColumns(file, hrrr);
  ExpectCloudsAtTheirPlaces(file, hrrr, hrrr.Samples());
}

// Grids of latitudes and longitudes are resampled, and the error of distances is stated: ICON-EU
// with every 8th point, a cut of GFS at 1 degree, and the tropics over the date line.
TEST_F(GribWide, ReadsWideGridsOfDegrees) {
  const std::vector<std::pair<std::string, Domain>> domains = {
      {"ICON-EU", Degrees({173, 83}, 0.5, {29.5, 336.5})},
      {"GFS cut", Degrees({71, 41}, 1.0, {15.0, 230.0})},
      {"tropics", Degrees({81, 41}, 1.0, {-20.0, 140.0})}};
  for (const auto& [name, domain] : domains) {
    SCOPED_TRACE(name);
    const StormFile file = Describe(domain, domain.Samples());
    ExpectStatedScales(file, domain);
    EXPECT_GT(StatedScales(file).second, 1.01);
    EXPECT_LT(StatedScales(file).second, 1.12);
    ExpectCloudsAtTheirPlaces(file, domain, domain.Samples());
  }
}

// A domain of the size of a country has true distances, also far from the latitude at which the
// map's scale is true. The map factor is 1.06 at 20 N.
TEST_F(GribWide, GivesTrueDistancesOfSmallerDomains) {
  const LambertFormulas lambert(38.5, 38.5, -97.5);
  const EarthPlace first{18.0, -102.0};
  for (const Domain& domain :
       {Hrrr({200, 150}, {3000.0, 3000.0}, first), Degrees({150, 120}, 0.05, {57.0, 358.0})}) {
    const StormFile file = Describe(domain, domain.Samples());
    EXPECT_EQ(StatedScales(file), std::make_pair(1.0, 1.0));
    const auto [least, largest] = ScalesOn(file, domain);
    EXPECT_GT(least, 0.99);
    EXPECT_LT(largest, 1.01);
    ExpectCloudsAtTheirPlaces(file, domain, domain.Samples());
  }
}

// WGS 84 at the equator: a degree of latitude is 110 574 m, and one of longitude 111 320 m.
TEST_F(GribWide, MeasuresDegreesOnAnEllipsoid) {
  Domain domain = Degrees({30, 30}, 0.05, {-0.725, 10.0});
  domain.grid.replace(9, 1, Number(5, 1));
  const StormFile file = Describe(domain);
  const volume::MapProjection map = MapOf(file);
  const auto from_m = map.WorldOf({-0.5, 10.725});
  const auto north_m = map.WorldOf({0.5, 10.725});
  const auto east_m = map.WorldOf({-0.5, 11.225});
  EXPECT_NEAR(glm::distance(*from_m, *north_m), 110'574.0, 30.0);
  EXPECT_NEAR(2.0 * glm::distance(*from_m, *east_m), 111'316.0, 30.0);
  EXPECT_NEAR(file.dy_m * file.cells.y, 1.5 * 110'574.0, 0.3 * file.dy_m);
  EXPECT_NEAR(file.dx_m * file.cells.x, 1.5 * 111'320.0, 0.3 * file.dx_m);
}

}  // namespace
}  // namespace thunderhead::storm_files
