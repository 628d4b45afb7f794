// Tests of the true distances between the columns of WRF files.
#include "storm_files/wrf_columns.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "glm/geometric.hpp"
#include "storm_files/storm_format.h"
#include "storm_store/storm_catalogue.h"
#include "tests/support/earth_formulas.h"
#include "tests/support/synthetic_wrf.h"
#include "tests/support/temporary_folder.h"
#include "volume/map_projection.h"

namespace thunderhead::storm_files {
namespace {

using testing::Distance_m;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::SyntheticWrf;
using testing::WrfCell;
using volume::EarthPlace;

// A moving nest of 48 by 40 columns in a Mercator projection whose scale is true at the equator.
// The map factor is about 1.1. At each record the nest is 100 km farther west and north on the map.
// Its middle column has cloud.
SyntheticWrf Nest() {
  SyntheticWrf file;
  file.nx = 48;
  file.ny = 40;
  file.levels = 3;
  file.dx_m = file.dy_m = 10'000.0;
  file.times = {"2013-05-20_20:00:00", "2013-05-20_21:00:00"};
  file.map_projection = 3;
  file.microphysics = 2;  // a scheme whose QCLOUD is liquid
  file.numbers = {{"TRUELAT1", 0.0}, {"STAND_LON", -89.0}};
  const auto place = [](const WrfCell& cell) {
    return testing::FromMercator(
        {1e4 * cell.x - 1e5 * cell.record - 290e3, 1e4 * cell.y + 1e5 * cell.record + 2.49e6}, 0.0,
        -89.0);
  };
  file.columns["XLAT"] = [=](const WrfCell& cell) { return place(cell).latitude_deg; };
  file.columns["XLONG"] = [=](const WrfCell& cell) { return place(cell).longitude_deg; };
  file.mixing_ratios["QCLOUD"] = [](const WrfCell& cell) {
    return std::abs(cell.x - 24) < 4 && std::abs(cell.y - 30) < 4 ? 1e-3 : 0.0;
  };
  return file;
}

class WrfColumns : public ::testing::Test {
 protected:
  StormFile Describe(const SyntheticWrf& file) {
    const std::string path = folder_.File("wrfout");
    testing::WriteWrf(file, path);
    auto described = StormFormats::BuiltIn().Describe(path);
    EXPECT_TRUE(described.ok()) << described.status();
    return *std::move(described);
  }

  testing::TemporaryFolder folder_;
};

// Returns the world coordinates of the middle of the cloud.
glm::dvec2 CloudMiddle_m(const StormFile& file, const volume::HydrometeorFields& fields) {
  glm::dvec2 moment(0.0);
  double sum = 0.0;
  for (int y = 0; y < file.cells.y; ++y) {
    for (int x = 0; x < file.cells.x; ++x) {
      const double value = fields.fields[0].concentration_kg_per_m3[fields.grid.Offset(x, y, 1)];
      moment += value * glm::dvec2(x, y);
      sum += value;
    }
  }
  const glm::dvec2 column = moment / sum - 0.5 * glm::dvec2(glm::ivec2(file.cells) - 1);
  return column * glm::dvec2(fields.grid.spacing_m);
}

// Returns the place of the middle of the cloud on a stereographic map around `middle`.
EarthPlace CloudPlace(const StormFile& file, const volume::HydrometeorFields& fields,
                      const EarthPlace& middle) {
  return testing::FromStereographic(CloudMiddle_m(file, fields), middle);
}

TEST_F(WrfColumns, AProjectedLengthIsNoTrueLength) {
  const SyntheticWrf wrf = Nest();
  const StormFile file = Describe(wrf);
  const auto place = [&](int x, int y) {
    return EarthPlace{wrf.columns.at("XLAT")({x, y}), wrf.columns.at("XLONG")({x, y})};
  };
  const double across_m = Distance_m(place(0, 20), place(47, 20)) / 47.0;
  EXPECT_NEAR(across_m, 9100.0, 100.0);
  EXPECT_NEAR(file.dx_m / across_m, 1.0, 0.01);
  EXPECT_NEAR(file.dy_m / across_m, 1.0, 0.01);
  EXPECT_THAT(file.projection, HasSubstr("+proj=stere"));
  EXPECT_THAT(file.assumptions,
              ::testing::Contains(HasSubstr("resampled to even distances of 91")));
  EXPECT_GE(file.cells.x, 47);
  EXPECT_LE(file.cells.x, 50);

  const auto fields = file.reader->Read(0, std::nullopt, {});
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ(glm::ivec2(fields->grid.cells), glm::ivec2(file.cells));
  EXPECT_EQ(fields->grid.spacing_m.x, file.dx_m);
  const EarthPlace middle{*file.latitude_deg, *file.longitude_deg};
  EXPECT_LT(Distance_m(CloudPlace(file, *fields, middle), place(24, 30)), 0.25 * file.dx_m);
}

// Files of wrf-python have the places of the columns, but not the attributes DX and DY.
TEST_F(WrfColumns, PlacesGiveTheDistancesWithoutDx) {
  const StormFile expected = Describe(Nest());
  SyntheticWrf wrf = Nest();
  wrf.omitted = {"DX", "DY"};
  const StormFile file = Describe(wrf);
  EXPECT_EQ(file.dx_m, expected.dx_m);
  EXPECT_EQ(file.dy_m, expected.dy_m);
  EXPECT_EQ(file.cells, expected.cells);
  // Columns that are already even are as far apart as their places say.
  SyntheticWrf even;
  even.mixing_ratios["QCLOUD"] = [](const WrfCell&) { return 1e-3; };
  even.nx = even.ny = 10;
  even.latitude_deg = 35.0;
  even.omitted = {"DX", "DY"};
  const StormFile described = Describe(even);
  EXPECT_NEAR(described.dx_m, 1000.0, 2.0);
  EXPECT_NEAR(described.dy_m, 2000.0, 4.0);
  EXPECT_THAT(described.assumptions,
              ::testing::Contains(HasSubstr("the file has no attributes DX and DY")));
  even.omitted.insert("XLAT");
  const std::string path = folder_.File("nowhere");
  testing::WriteWrf(even, path);
  EXPECT_THAT(std::string(StormFormats::BuiltIn().Describe(path).status().message()),
              HasSubstr("DX and DY (metres, above zero) are missing or wrong, and no latitudes"));
}

TEST_F(WrfColumns, EachTimeOfAMovingNestIsAtItsPlace) {
  const SyntheticWrf wrf = Nest();
  const StormFile file = Describe(wrf);
  const auto first = file.reader->Read(0, std::nullopt, {});
  const auto second = file.reader->Read(1, std::nullopt, {});
  ASSERT_TRUE(first.ok() && second.ok()) << second.status();
  EXPECT_EQ(first->grid.cells, second->grid.cells);
  const auto place = [&](int x, int y) {
    return EarthPlace{wrf.columns.at("XLAT")({x, y, 0, 1}), wrf.columns.at("XLONG")({x, y, 0, 1})};
  };
  // The nest's middle is between four columns.
  EarthPlace middle{0.25 * (place(23, 19).latitude_deg + place(24, 19).latitude_deg +
                            place(23, 20).latitude_deg + place(24, 20).latitude_deg),
                    0.5 * (place(23, 19).longitude_deg + place(24, 19).longitude_deg)};
  EXPECT_LT(Distance_m(CloudPlace(file, *second, middle), place(24, 30)),
            0.25 * second->grid.spacing_m.x);
  EXPECT_NE(first->fields[0].concentration_kg_per_m3, second->fields[0].concentration_kg_per_m3);
}

TEST_F(WrfColumns, FilesOfAMovingNestAreOneStorm) {
  SyntheticWrf later = Nest();
  SyntheticWrf first = later;
  first.times.resize(1);
  later.times = {"2013-05-20_21:00:00"};
  for (const char* const name : {"XLAT", "XLONG"}) {
    later.columns[name] = [value = later.columns[name]](WrfCell cell) {
      cell.record = 1;
      return value(cell);
    };
  }
  std::filesystem::create_directory(folder_.File("run"));
  testing::WriteWrf(first, folder_.File("run/wrfout_a"));
  testing::WriteWrf(later, folder_.File("run/wrfout_b"));
  const auto storms = storm_store::FindStorms({folder_.File("run")}, StormFormats::BuiltIn(), {});
  ASSERT_TRUE(storms.ok()) << storms.status();
  ASSERT_EQ(storms->size(), 1U);
  EXPECT_EQ(storms->front().info.times.size(), 2U);
}

// A program that keeps every second column leaves DX as it was.
TEST_F(WrfColumns, PlacesGiveTheDistanceInsteadOfDx) {
  SyntheticWrf wrf = Nest();
  wrf.columns.clear();
  wrf.map_projection = 1;
  wrf.numbers = {{"TRUELAT1", 30.0}, {"TRUELAT2", 60.0}, {"STAND_LON", -97.0}};
  const testing::LambertFormulas lambert(30.0, 60.0, -97.0);
  const auto place = [=](const WrfCell& cell) {
    return lambert.PlaceOf({2000.0 * cell.x, 2000.0 * cell.y - lambert.FromTip_m(45.0)});
  };
  wrf.dx_m = wrf.dy_m = 1000.0;
  wrf.columns["XLAT"] = [=](const WrfCell& cell) { return place(cell).latitude_deg; };
  wrf.columns["XLONG"] = [=](const WrfCell& cell) { return place(cell).longitude_deg; };
  const StormFile file = Describe(wrf);
  EXPECT_EQ(file.cells, glm::ivec3(48, 40, 3));
  EXPECT_NEAR(file.dx_m, Distance_m(place({20, 20}), place({21, 20})), 6.0);
  EXPECT_NEAR(file.dx_m, 2000.0 / lambert.Scale(45.0), 6.0);
  EXPECT_THAT(file.projection, HasSubstr("+proj=lcc"));
  EXPECT_THAT(file.assumptions, ElementsAre(HasSubstr("DX and DY")));
}

TEST_F(WrfColumns, IdealisedRunsAndShortDomainsKeepDx) {
  SyntheticWrf idealised = Nest();
  idealised.map_projection = 0;
  SyntheticWrf short_domain = Nest();
  short_domain.columns.clear();
  short_domain.dx_m = short_domain.dy_m = 10.0;
  short_domain.numbers["TRUELAT1"] = short_domain.latitude_deg;
  for (const SyntheticWrf& wrf : {idealised, short_domain}) {
    const StormFile file = Describe(wrf);
    EXPECT_EQ(file.dx_m, wrf.dx_m);
    EXPECT_EQ(file.dy_m, wrf.dy_m);
    EXPECT_EQ(file.cells, glm::ivec3(wrf.nx, wrf.ny, wrf.levels));
    EXPECT_THAT(file.assumptions, ::testing::Each(::testing::Not(HasSubstr("columns"))));
  }
}

TEST_F(WrfColumns, TheMapFactorGivesTheDistancesOfShortDomains) {
  SyntheticWrf wrf = Nest();
  wrf.columns.clear();
  wrf.dx_m = wrf.dy_m = 10.0;
  wrf.columns["MAPFAC_M"] = [](const WrfCell& cell) { return cell.x % 2 == 0 ? 1.9 : 2.1; };
  const StormFile file = Describe(wrf);
  EXPECT_NEAR(file.dx_m, 5.0, 1e-5);
  EXPECT_NEAR(file.dy_m, 5.0, 1e-5);
  EXPECT_THAT(file.assumptions, ::testing::Contains(HasSubstr("mean map factor 2")));
}

// Returns a file of 10 km on the map of MAP_PROJ `projection` with CEN_LAT `latitude_deg`, without
// the places of its columns. It is the whole outermost domain.
SyntheticWrf WithoutPlaces(int projection, double latitude_deg,
                           const std::map<std::string, double>& numbers) {
  SyntheticWrf wrf = Nest();
  wrf.columns.clear();
  wrf.times.resize(1);
  wrf.map_projection = projection;
  wrf.numbers = {{"STAND_LON", -97.0},
                 {"CEN_LAT", latitude_deg},
                 {"CEN_LON", -97.0},
                 {"WEST-EAST_GRID_DIMENSION", 49.0},
                 {"SOUTH-NORTH_GRID_DIMENSION", 41.0}};
  for (const auto& [name, value] : numbers) wrf.numbers[name] = value;
  wrf.omitted = {"XLAT", "XLONG"};
  return wrf;
}

// The scales are those of Snyder 1987, equations 7-5, 15-4 and 21-33, on a sphere.
TEST_F(WrfColumns, TheProjectionGivesTheDistancesWithoutPlaces) {
  const testing::LambertFormulas lambert(30.0, 60.0, -97.0);
  struct Case {
    SyntheticWrf wrf;
    double scale_x;
    double scale_y;
    std::string projection;
  };
  const double polar = (1.0 + std::sin(glm::radians(60.0))) / (1.0 + std::sin(glm::radians(80.0)));
  const std::vector<Case> cases = {
      {WithoutPlaces(3, 60.0, {{"TRUELAT1", 0.0}}), 2.0, 2.0, "+proj=merc +lat_ts=60 "},
      {WithoutPlaces(3, -60.0, {{"TRUELAT1", 0.0}}), 2.0, 2.0, "+proj=merc +lat_ts=-60 "},
      {WithoutPlaces(2, 80.0, {{"TRUELAT1", 60.0}}), polar, polar,
       "+proj=stere +lat_0=90 +lat_ts=80 "},
      {WithoutPlaces(2, -80.0, {{"TRUELAT1", -60.0}}), polar, polar,
       "+proj=stere +lat_0=-90 +lat_ts=-80 "},
      {WithoutPlaces(1, 45.0, {{"TRUELAT1", 30.0}, {"TRUELAT2", 60.0}}), lambert.Scale(45.0),
       lambert.Scale(45.0), "+proj=lcc "},
      {WithoutPlaces(6, 60.0, {{"POLE_LAT", 90.0}}), 2.0, 1.0, ""},
  };
  for (const Case& each : cases) {
    const StormFile file = Describe(each.wrf);
    const std::string about = each.projection + std::to_string(*file.latitude_deg);
    EXPECT_NEAR(file.dx_m, 10'000.0 / each.scale_x, 0.5) << about;
    EXPECT_NEAR(file.dy_m, 10'000.0 / each.scale_y, 0.5) << about;
    EXPECT_THAT(file.projection, ::testing::StartsWith(each.projection)) << about;
    EXPECT_THAT(file.assumptions,
                ::testing::Contains(HasSubstr("degrees north (the middle of the domain)")))
        << about;
    // Lengths on the storm's map are true in its middle.
    if (each.projection.empty()) continue;
    const EarthPlace middle{*file.latitude_deg, *file.longitude_deg};
    const auto map = volume::MapProjection::Of(file.projection, middle);
    ASSERT_TRUE(map.ok()) << map.status();
    EXPECT_NEAR(Distance_m(*map->PlaceOf({0.0, 1000.0}), middle), 1000.0, 2.0) << about;
  }
}

TEST_F(WrfColumns, AFileWithoutPlacesOrScaleSaysSo) {
  // A part of a domain has no place on Earth, but a latitude.
  SyntheticWrf part = WithoutPlaces(3, 60.0, {{"TRUELAT1", 0.0}});
  part.numbers.erase("WEST-EAST_GRID_DIMENSION");
  StormFile file = Describe(part);
  EXPECT_FALSE(file.latitude_deg.has_value());
  EXPECT_NEAR(file.dx_m, 5000.0, 0.1);
  EXPECT_THAT(file.assumptions,
              ::testing::Contains("The distances between columns are DX and DY divided by the map "
                                  "factor 2, which the projection has at 60 degrees north "
                                  "(CEN_LAT)."));
  // Units that are no degrees leave only CEN_LAT, too.
  SyntheticWrf in_metres = part;
  in_metres.omitted = {};
  in_metres.units = {{"XLAT", "m"}};
  EXPECT_NEAR(Describe(in_metres).dx_m, 5000.0, 0.1);
  // Nothing gives the scale.
  SyntheticWrf unknown = part;
  unknown.numbers.erase("CEN_LAT");
  SyntheticWrf rotated = WithoutPlaces(6, 60.0, {{"POLE_LAT", 40.0}});
  for (const SyntheticWrf& wrf : {unknown, rotated}) {
    file = Describe(wrf);
    EXPECT_EQ(file.dx_m, 10'000.0);
    EXPECT_THAT(file.assumptions, ::testing::Contains(HasSubstr("True distances can differ")));
  }
}

TEST_F(WrfColumns, EachAxisHasItsOwnMapFactor) {
  SyntheticWrf wrf = WithoutPlaces(6, 60.0, {});
  wrf.columns["MAPFAC_MX"] = [](const WrfCell&) { return 2.0; };
  wrf.columns["MAPFAC_MY"] = [](const WrfCell&) { return 1.25; };
  StormFile file = Describe(wrf);
  EXPECT_NEAR(file.dx_m, 5000.0, 1e-3);
  EXPECT_NEAR(file.dy_m, 8000.0, 1e-3);
  EXPECT_THAT(file.assumptions,
              ::testing::Contains(HasSubstr("the mean map factors 2 along x and 1.25 along y.")));
  // A map factor that is missing somewhere is not used, and the projection gives it.
  wrf.columns["MAPFAC_MX"] = [](const WrfCell& cell) { return cell.x == 0 ? std::nan("") : 3.0; };
  file = Describe(wrf);
  EXPECT_NEAR(file.dx_m, 5000.0, 0.5);
  EXPECT_NEAR(file.dy_m, 10'000.0, 0.5);
}

// The latitude of a nest changes its distances, but not its grid.
TEST_F(WrfColumns, ARunWhoseScaleChangesIsOneStorm) {
  SyntheticWrf first = WithoutPlaces(3, 60.0, {{"TRUELAT1", 0.0}});
  first.domain = 2;
  SyntheticWrf later = first;
  later.times = {"2013-05-20_21:00:00"};
  later.numbers["CEN_LAT"] = 61.0;
  std::filesystem::create_directory(folder_.File("nest"));
  testing::WriteWrf(first, folder_.File("nest/wrfout_a"));
  testing::WriteWrf(later, folder_.File("nest/wrfout_b"));
  const auto storms = storm_store::FindStorms({folder_.File("nest")}, StormFormats::BuiltIn(), {});
  ASSERT_TRUE(storms.ok()) << storms.status();
  EXPECT_EQ(storms->size(), 1U);
}

// A file of one row gives no distance along y, so both are those of the projection. The middle of
// the row is at 21.82 degrees north, where the scale is 1 / cos(21.82 deg) = 1.0772.
TEST_F(WrfColumns, TheProjectionGivesTheDistancesOfOneRow) {
  SyntheticWrf of_one_row = Nest();
  of_one_row.ny = 1;
  const StormFile file = Describe(of_one_row);
  EXPECT_EQ(file.cells, glm::ivec3(48, 1, 3));
  EXPECT_NEAR(file.dx_m, 10'000.0 * std::cos(glm::radians(*file.latitude_deg)), 0.1);
  EXPECT_NEAR(file.dx_m, 9283.0, 20.0);
  EXPECT_EQ(file.dy_m, file.dx_m);
}

// DX is a length on the map, so it is not the distance if the places cannot give it.
TEST_F(WrfColumns, MissingPlacesAreAnError) {
  SyntheticWrf wrf = Nest();
  const auto latitude = wrf.columns.at("XLAT");
  wrf.columns["XLAT"] = [latitude](const WrfCell& cell) {
    return cell.x == 0 && cell.y == 0 ? std::nan("") : latitude(cell);
  };
  const std::string path = folder_.File("wrfout");
  testing::WriteWrf(wrf, path);
  EXPECT_FALSE(StormFormats::BuiltIn().Describe(path).ok());
}

// The columns of a continent stay on its Lambert map, and the errors of distances are stated.
TEST_F(WrfColumns, ReadsAContinentOnItsMap) {
  SyntheticWrf wrf = Nest();
  wrf.nx = 60;
  wrf.ny = 50;
  wrf.dx_m = wrf.dy_m = 80e3;
  wrf.map_projection = 1;
  wrf.times.resize(1);
  wrf.numbers = {{"TRUELAT1", 30.0}, {"TRUELAT2", 60.0}, {"STAND_LON", -97.0}};
  const testing::LambertFormulas lambert(30.0, 60.0, -97.0);
  const auto place = [=](const WrfCell& cell) {
    return lambert.PlaceOf({80e3 * cell.x - 2.4e6, 80e3 * cell.y - 9.2e6});
  };
  wrf.columns["XLAT"] = [=](const WrfCell& cell) { return place(cell).latitude_deg; };
  wrf.columns["XLONG"] = [=](const WrfCell& cell) { return place(cell).longitude_deg; };
  const StormFile file = Describe(wrf);
  EXPECT_EQ(file.cells, glm::ivec3(60, 50, 3));
  EXPECT_THAT(file.projection, HasSubstr("+proj=lcc"));
  EXPECT_THAT(file.assumptions,
              ElementsAre(HasSubstr("DX and DY"), HasSubstr("true in the middle, and ")));
  EXPECT_NEAR(file.dx_m, Distance_m(place({29, 25}), place({30, 25})), 0.003 * 80e3);
  const auto map =
      volume::MapProjection::Of(file.projection, {*file.latitude_deg, *file.longitude_deg});
  ASSERT_TRUE(map.ok()) << map.status();
  const auto fields = file.reader->Read(0, std::nullopt, {});
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ(fields->grid.spacing_m.x, file.dx_m);
  for (const WrfCell& cell : {WrfCell{0, 0}, WrfCell{59, 0}, WrfCell{0, 49}, WrfCell{59, 49}}) {
    const glm::dvec2 world_m =
        glm::dvec2(fields->grid.low_corner_m) +
        (glm::dvec2(cell.x, cell.y) + 0.5) * glm::dvec2(fields->grid.spacing_m);
    const auto at = map->PlaceOf(world_m);
    ASSERT_TRUE(at.has_value());
    EXPECT_LT(Distance_m(*at, place(cell)), 0.05 * file.dx_m) << cell.x << ", " << cell.y;
  }
}

// Columns without a map projection are resampled to one.
TEST_F(WrfColumns, ResamplesAContinentWithoutAMap) {
  SyntheticWrf wrf = Nest();
  wrf.nx = wrf.ny = 20;
  wrf.times.resize(1);
  wrf.columns["XLAT"] = [](const WrfCell& cell) { return 20.0 + 2.0 * cell.y; };
  wrf.columns["XLONG"] = [](const WrfCell& cell) { return -100.0 + 2.0 * cell.x; };
  wrf.mixing_ratios["QCLOUD"] = [](const WrfCell& cell) {
    return std::abs(cell.x - 16) < 2 && std::abs(cell.y - 3) < 2 ? 1e-3 : 0.0;
  };
  const StormFile file = Describe(wrf);
  EXPECT_THAT(file.assumptions,
              ElementsAre(HasSubstr("resampled"), HasSubstr("true in the middle, and ")));
  const auto fields = file.reader->Read(0, std::nullopt, {});
  ASSERT_TRUE(fields.ok()) << fields.status();
  const auto map =
      volume::MapProjection::Of(file.projection, {*file.latitude_deg, *file.longitude_deg});
  ASSERT_TRUE(map.ok()) << map.status();
  const auto cloud = map->PlaceOf(CloudMiddle_m(file, *fields));
  ASSERT_TRUE(cloud.has_value());
  EXPECT_LT(Distance_m(*cloud, {26.0, -68.0}), 0.5 * file.dx_m);
}

}  // namespace
}  // namespace thunderhead::storm_files
