// Tests of what CF files leave unsaid or say in an unusual place. Each is read rightly, stated or
// refused. They cover sizes of single cells, numbers of columns, lost grid mappings, cell_methods
// and PALM's origin. They also cover pressure levels without a standard name, and lead times.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "storm_files/cell_methods.h"
#include "storm_files/cf_writer.h"
#include "tests/unit/storm_files/cf_file_test.h"

namespace thunderhead::storm_files {
namespace {

using testing::CfContent;
using ::testing::Contains;
using ::testing::Each;
using ::testing::HasSubstr;
using testing::Middles;
using ::testing::Not;
using testing::SyntheticCf;

class CfUnsaid : public CfFileTest {
 protected:
  // Reads a file that must be readable.
  std::shared_ptr<const volume::HydrometeorFields> MustRead(const SyntheticCf& file) {
    auto fields = Read(file);
    EXPECT_TRUE(fields.ok()) << fields.status();
    return fields.ok() ? *std::move(fields) : nullptr;
  }
};

// Returns cloud water of 1e-4 kg m-3 in the lowest layers of 500 m, on 6 x 4 columns of 1 km.
SyntheticCf Water(std::size_t layers = 4) {
  SyntheticCf file = testing::ExtinctionFile(6, 4, layers, 1000.0, 1000.0, 500.0, {});
  file.variables[0] = {"qc", {"z", "y", "x"}, {{"units", "kg m-3"}}, [](const Index& at) {
                         return at.at("z") == 0 ? 1e-4 : 0.0;
                       }};
  return file;
}

// Adds longitudes and latitudes of all columns, `step_deg` apart from 10 E and from `south_deg`.
void AddPlaces(SyntheticCf& file, double south_deg, double step_deg) {
  file.variables.push_back(
      {"lon", {"y", "x"}, {{"units", "degrees_east"}}, [step_deg](const Index& at) {
         return 10.0 + step_deg * static_cast<double>(at.at("x"));
       }});
  file.variables.push_back(
      {"lat", {"y", "x"}, {{"units", "degrees_north"}}, [south_deg, step_deg](const Index& at) {
         return south_deg + step_deg * static_cast<double>(at.at("y"));
       }});
}

TEST_F(CfUnsaid, ASingleLayerNeedsBounds) {
  SyntheticCf file = Water(1);
  EXPECT_NE(MustRead(file), nullptr);
  file.coordinates[2].values = {3750.0};
  file.coordinates[2].faces = {};
  ExpectError(file, "z has one layer and no bounds, so its thickness is not known");
  // An array with the height of the only layer does not say how thick it is, either.
  file.variables.push_back(OfOneValue(
      "zg", {"z", "y", "x"}, {{"units", "m"}, {"standard_name", "geopotential_height"}}, 3750));
  ExpectError(file, "zg has the height of one layer and not of its interfaces");
}

// Clouds that this program writes have bounds, so that a single cell is read back with its size.
TEST_F(CfUnsaid, AWrittenCloudOfOneCellKeepsItsSize) {
  const volume::RegularGrid grid{{1, 1, 1}, {10.0, 20.0, 30.0}, {-500.0, 700.0, 900.0}};
  ASSERT_TRUE(
      WriteCfCloud({grid, volume::Quantity::kExtinction, {0.5F}, "a", "b", "c"}, path_).ok());
  const auto store = storm_store::StormStore::Open({path_}, {.read_ahead = 0});
  ASSERT_TRUE(store.ok()) << store.status();
  const auto fields = (*store)->Get((*store)->Storms().front()->id, 0, {});
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ((*fields)->grid.spacing_m, grid.spacing_m);
  EXPECT_EQ((*fields)->grid.low_corner_m.z, 900.0);
}

TEST_F(CfUnsaid, TheWidthOfASingleRowIsStated) {
  SyntheticCf file = Water();
  file.coordinates[1].values = {7500.0};
  const auto fields = MustRead(file);
  ASSERT_NE(fields, nullptr);
  EXPECT_EQ(fields->grid.spacing_m.y, 1000.0);
  EXPECT_THAT(
      info_.assumptions,
      Contains("y has one cell and no bounds; the cell is taken to be 1000 m wide, like the "
               "cells along the other axis."));
}

TEST_F(CfUnsaid, NumbersOfColumnsAreNoPlaces) {
  for (const auto& [units, said] : {std::pair{"1", "has units '1' and numbers the cells"},
                                    std::pair{"", "has no units and numbers the cells"}}) {
    SyntheticCf file = Water();
    for (std::size_t axis = 0; axis < 2; ++axis) {
      file.coordinates[axis].attributes = {{"units", units}};
      for (std::size_t i = 0; i < file.coordinates[axis].values.size(); ++i) {
        file.coordinates[axis].values[i] = static_cast<double>(i);
      }
    }
    ExpectError(file, said);
    // Longitudes and latitudes of the columns tell where they are.
    AddPlaces(file, 50.0, 0.01);
    const auto fields = MustRead(file);
    ASSERT_NE(fields, nullptr);
    EXPECT_NEAR(info_.latitude_deg.value(), 50.015, 1e-4);
    EXPECT_NEAR(info_.longitude_deg.value(), 10.025, 1e-4);
    EXPECT_NEAR(fields->grid.spacing_m.y, 6.371e6 * 0.01 * std::numbers::pi / 180.0, 10.0);
  }
}

// Returns the file with these values and attributes on its height axis.
SyntheticCf WithHeights(const std::vector<double>& values, Texts attributes) {
  SyntheticCf file = Water(values.size());
  file.coordinates[2].values = values;
  file.coordinates[2].attributes = std::move(attributes);
  file.coordinates[2].faces = {};
  return file;
}

TEST_F(CfUnsaid, NumbersOfLayersAreNoHeights) {
  for (const double first : {0.0, 1.0, 7.0}) {
    std::vector<double> numbers;
    for (int i = 0; i < 200; ++i) numbers.push_back(first + i);
    ExpectError(WithHeights(numbers, {}), "the coordinate z has no units, and its values");
    std::ranges::reverse(numbers);
    ExpectError(WithHeights(numbers, {}), "number the levels");
  }
  // With units, or with other values, they are heights.
  EXPECT_NE(MustRead(WithHeights({1.0, 2.0, 3.0}, {{"units", "m"}})), nullptr);
  EXPECT_NE(MustRead(WithHeights({25.0, 75.0, 125.0}, {})), nullptr);
  EXPECT_THAT(info_.assumptions, Contains("z has no units; it is taken to be in m."));
  // Heights in km, or every second level.
  for (const std::vector<double>& values :
       {std::vector{0.25, 0.75, 1.25}, std::vector{1.0, 3.0, 5.0}}) {
    ExpectError(WithHeights(values, {}),
                "the coordinate z has no units, and in m its layers would be only");
  }
  ExpectError(WithHeights({100.0, 200.0, 300.0}, {{"long_name", "index"}}),
              "holds numbers of levels");
}

TEST_F(CfUnsaid, HeightsFarAboveTheWeatherAreRefused) {
  const std::vector<double> heights = {250.0, 750.0, 1250.0};
  EXPECT_NE(MustRead(WithHeights(heights, {{"units", "m"}})), nullptr);
  ExpectError(WithHeights(heights, {{"units", "km"}}),
              "the coordinate z (units 'km') reaches up to 1500 km, far above the weather");
  ExpectError(WithHeights({-1250.0, -750.0, -250.0}, {{"units", "m"}}),
              "the coordinate z has no value above 0, so its layers lie 0 to 1500 m below sea");
  // The same holds for an array of heights.
  SyntheticCf file = WithHeights({1.0, 2.0, 3.0}, {{"units", "1"}});
  file.variables.push_back({"zg",
                            {"z", "y", "x"},
                            {{"units", "m"}, {"standard_name", "geopotential_height"}},
                            [heights](const Index& at) { return heights[at.at("z")]; }});
  EXPECT_NE(MustRead(file), nullptr);
  file.variables.back().attributes["units"] = "km";
  ExpectError(file, "the heights zg of record 0 reach up to 1500 km, far above the weather");
}

// If rows run from north to south although their numbers rise, the reader reverses their order.
TEST_F(CfUnsaid, NumbersOfRowsDoNotSayWhereNorthIs) {
  SyntheticCf file = Water();
  for (std::size_t axis = 0; axis < 2; ++axis) {
    file.coordinates[axis].attributes = {{"units", "1"}};
    for (std::size_t i = 0; i < file.coordinates[axis].values.size(); ++i) {
      file.coordinates[axis].values[i] = static_cast<double>(i + 1);
    }
  }
  AddPlaces(file, 50.0, 0.01);
  file.variables.back().value = [](const Index& at) {
    return 50.03 - 0.01 * static_cast<double>(at.at("y"));
  };
  file.variables[0].value = [](const Index& at) {
    return at.at("z") == 0 && at.at("y") == 0 ? 1e-4 : 0.0;
  };
  const auto fields = MustRead(file);
  ASSERT_NE(fields, nullptr);
  const volume::RegularGrid& grid = fields->grid;
  EXPECT_GT(fields->fields[0].concentration_kg_per_m3[grid.Offset(2, grid.cells.y - 1, 0)], 5e-5);
  EXPECT_EQ(fields->fields[0].concentration_kg_per_m3[grid.Offset(2, 0, 0)], 0.0F);
}

TEST_F(CfUnsaid, RotatedDegreesNeedUnits) {
  SyntheticCf file = Water();
  file.coordinates[0] = {"rlon", {1.0, 1.02, 1.04, 1.06, 1.08, 1.1}, {}, {}};
  file.coordinates[1] = {"rlat", {1.0, 1.02, 1.04, 1.06}, {}, {}};
  file.variables[0].dimensions = {"z", "rlat", "rlon"};
  ExpectError(file, "has no units; add them: degrees, m or km");
}

TEST_F(CfUnsaid, ALostGridMappingIsStated) {
  SyntheticCf file = Water();
  file.variables[0].attributes["grid_mapping"] = "crs";
  EXPECT_NE(MustRead(file), nullptr);
  EXPECT_FALSE(info_.latitude_deg.has_value());
  EXPECT_THAT(info_.assumptions, Contains("The grid mapping crs, which qc names, is not in the "
                                          "file, so the place on Earth is not known."));
  AddPlaces(file, 50.0, 0.01);
  EXPECT_NE(MustRead(file), nullptr);
  EXPECT_THAT(info_.assumptions, Contains("The grid mapping crs, which qc names, is not in the "
                                          "file, so the places are those of the coordinates."));
  // A mapping that no field names is not used.
  file = Water();
  file.variables.push_back(
      OfOneValue("crs", {}, {{"grid_mapping_name", "transverse_mercator"}}, 0.0));
  EXPECT_NE(MustRead(file), nullptr);
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("qc does not name the grid mapping crs")));
}

TEST(CellMethodsTest, MeansOverCellsAreValues) {
  for (const char* value : {"", "time: point", "area: mean", "area: mean time: point",
                            "lat: lon: mean", "area: time: point (interval: 1 h sum: of all)"}) {
    EXPECT_EQ(MeaningOfCellMethods(value), CellMethod::kValue) << value;
  }
  for (const char* statistic :
       {"time: mean", "time: mean (interval: 1 day)", "area: mean time: maximum", "time: minimum",
        "area: mean where cloud", "realization: mean", "area: time: mean"}) {
    EXPECT_EQ(MeaningOfCellMethods(statistic), CellMethod::kStatistic) << statistic;
  }
  for (const char* none : {"time: variance", "area: mean time: standard_deviation", "time: range",
                           "time: sum", "time: mean area: sum", "Time: Variance"}) {
    EXPECT_EQ(MeaningOfCellMethods(none), CellMethod::kNoAmount) << none;
  }
}

TEST_F(CfUnsaid, VariancesAreNoAmountsOfWater) {
  SyntheticCf file = Water();
  EXPECT_NE(MustRead(file), nullptr);
  EXPECT_THAT(info_.assumptions, Each(Not(HasSubstr("cell_methods"))));
  file.variables[0].attributes["cell_methods"] = "time: maximum";
  EXPECT_NE(MustRead(file), nullptr);
  EXPECT_THAT(
      info_.assumptions,
      Contains("qc is shown as the amount at each time, but it is a statistic (cell_methods "
               "'time: maximum')."));
  file.variables[0].attributes["cell_methods"] = "time: variance";
  ExpectError(file, "qc has cell_methods 'time: variance', so its values are no amounts of water");
  // A variance next to the amounts is left out, in whichever order they are.
  CfContent amounts = Water().variables[0];
  amounts.name = "clw";
  file.variables.push_back(amounts);
  const auto fields = MustRead(file);
  ASSERT_NE(fields, nullptr);
  ASSERT_EQ(fields->fields.size(), 1U);
  EXPECT_EQ(fields->fields[0].variable, "clw");
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("qc is left out, because its cell_methods")));
}

// PALM's x, y and z count from an origin in the file's global attributes.
SyntheticCf Palm() {
  SyntheticCf file;
  file.coordinates = {{"x", Middles(6, 0.0, 100.0), {{"units", "m"}}, {}},
                      {"y", Middles(4, 0.0, 100.0), {{"units", "m"}}, {}},
                      {"zu_3d", Middles(4, 0.0, 50.0), {{"units", "m"}}, {}}};
  file.variables = {{"qc", {"zu_3d", "y", "x"}, {{"units", "kg m-3"}}, [](const Index& at) {
                       return at.at("zu_3d") == 2 ? 1e-4 : 0.0;
                     }}};
  file.number_attributes = {
      {"", {{"origin_lat", 52.5}, {"origin_lon", 13.3}, {"origin_z", 340.0}}}};
  return file;
}

TEST_F(CfUnsaid, PalmsOriginPlacesItsDomain) {
  constexpr double kMetresPerDegree = 6.371e6 * std::numbers::pi / 180.0;
  SyntheticCf file = Palm();
  auto fields = MustRead(file);
  ASSERT_NE(fields, nullptr);
  EXPECT_NEAR(fields->grid.low_corner_m.z, 340.0, 1e-3);
  EXPECT_EQ(fields->terrain_height_m[0], 340.0F);
  EXPECT_NEAR(info_.latitude_deg.value(), 52.5 + 200.0 / kMetresPerDegree, 1e-5);
  EXPECT_NEAR(info_.longitude_deg.value(),
              13.3 + 300.0 / (kMetresPerDegree * std::cos(52.5 * std::numbers::pi / 180.0)), 1e-5);
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("origin_lat, origin_lon")));
  EXPECT_THAT(info_.assumptions, Contains("The heights zu_3d count from the origin, which is 340 m "
                                          "above sea level (origin_z)."));
  // A turned grid gets no place on Earth, because its axes do not point east and north.
  file.number_attributes[""]["rotation_angle"] = 30.0;
  fields = MustRead(file);
  ASSERT_NE(fields, nullptr);
  EXPECT_FALSE(info_.latitude_deg.has_value());
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("turned by 30 degrees (rotation_angle)")));
}

TEST_F(CfUnsaid, HeightsAboveSeaLevelDoNotCountFromTheOrigin) {
  SyntheticCf file = Palm();
  file.coordinates[2].attributes["standard_name"] = "altitude";
  const auto fields = MustRead(file);
  ASSERT_NE(fields, nullptr);
  EXPECT_EQ(fields->grid.low_corner_m.z, 0.0);
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("origin_z (340 m) is not added")));
}

// PALM's crs describes E_UTM and N_UTM, not x and y.
TEST_F(CfUnsaid, AGridMappingThatContradictsTheOriginIsNotUsed) {
  SyntheticCf file = Palm();
  file.variables[0].attributes["grid_mapping"] = "crs";
  file.variables.push_back(
      OfOneValue("crs", {}, {{"grid_mapping_name", "transverse_mercator"}}, 0.0));
  file.number_attributes["crs"] = {{"latitude_of_projection_origin", 0.0},
                                   {"longitude_of_central_meridian", 15.0},
                                   {"scale_factor_at_central_meridian", 0.9996},
                                   {"false_easting", 500'000.0},
                                   {"false_northing", 0.0}};
  EXPECT_NE(MustRead(file), nullptr);
  EXPECT_NEAR(info_.latitude_deg.value(), 52.502, 1e-3);
  EXPECT_NEAR(info_.longitude_deg.value(), 13.304, 1e-3);
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("which the grid mapping contradicts")));
}

// A field may name several grid mappings, each with the coordinates that it maps (CF 1.8, 5.6).
TEST_F(CfUnsaid, TheGridMappingIsThatOfItsAxes) {
  SyntheticCf file = Water();
  file.variables.push_back(
      OfOneValue("wgs", {}, {{"grid_mapping_name", "latitude_longitude"}}, 0.0));
  file.variables.push_back(
      OfOneValue("map", {}, {{"grid_mapping_name", "polar_stereographic"}}, 0.0));
  file.number_attributes["map"] = {{"latitude_of_projection_origin", 90.0},
                                   {"straight_vertical_longitude_from_pole", 30.0},
                                   {"scale_factor_at_projection_origin", 1.0},
                                   {"earth_radius", 6'371'000.0}};
  for (std::size_t i = 0; i < 6; ++i)
    file.coordinates[0].values[i] = -2500.0 + 1000.0 * static_cast<double>(i);
  for (std::size_t i = 0; i < 4; ++i)
    file.coordinates[1].values[i] = -1e6 - 1500.0 + 1000.0 * static_cast<double>(i);
  for (const char* mapping : {"wgs: lat lon map: x y", "map: x y wgs: lat lon", "map: y x", "map",
                              "lost: lat lon map: x y"}) {
    file.variables[0].attributes["grid_mapping"] = mapping;
    EXPECT_NE(MustRead(file), nullptr);
    // The middle is 1000 km from the pole, along the map's vertical meridian.
    const double from_pole_deg =
        2.0 * std::atan(1e6 / 2.0 / 6'371'000.0) * 180.0 / std::numbers::pi;
    EXPECT_NEAR(info_.latitude_deg.value_or(0.0), 90.0 - from_pole_deg, 1e-3) << mapping;
    EXPECT_NEAR(info_.longitude_deg.value_or(0.0), 30.0, 1e-3) << mapping;
  }
}

// The density follows from the pressure of the levels.
TEST_F(CfUnsaid, LevelsInUnitsOfPressureAreThePressure) {
  for (const char* name : {"level", "pressure", "isobaric"}) {
    SyntheticCf file = Water();
    file.coordinates[2] = {name, {950.0, 900.0, 850.0, 800.0}, {{"units", "hPa"}}, {}};
    const std::vector<std::string> on = {name, "y", "x"};
    const std::string z = name;
    file.variables = {
        {"qc",
         on,
         {{"units", "kg kg-1"}},
         [z](const Index& at) { return at.at(z) == 1 ? 1e-4 : 0.0; }},
        OfOneValue("ta", on, {{"units", "K"}, {"standard_name", "air_temperature"}}, 280.0),
        {"zg",
         on,
         {{"units", "m"}, {"standard_name", "geopotential_height"}},
         [z](const Index& at) { return 500.0 + 500.0 * static_cast<double>(at.at(z)); }}};
    const auto fields = MustRead(file);
    ASSERT_NE(fields, nullptr) << name;
    const double path = 1e-4 * 500.0 * 90'000.0 / (287.0 * 280.0);
    EXPECT_NEAR(fields->fields[0].statistics.maximum_water_path_kg_per_m2, path, 2e-3 * path)
        << name;
    EXPECT_THAT(info_.assumptions, Contains(HasSubstr("are the air's pressure, by their units")));
    // The nominal pressure of hybrid levels is not the air's pressure.
    file.coordinates[2].attributes["long_name"] = "hybrid level at midpoints";
    ExpectError(file, "lacks the air's density");
  }
}

SyntheticCf Forecast(const std::string& calendar) {
  SyntheticCf file = Water();
  file.coordinates.push_back(
      {"time", {1.0, 2.0}, {{"units", "days since 2000-02-28"}, {"calendar", calendar}}, {}});
  file.variables[0].dimensions = {"time", "z", "y", "x"};
  file.variables.push_back(OfOneValue("reference", {},
                                      {{"standard_name", "forecast_reference_time"},
                                       {"units", "days since 2000-02-28"},
                                       {"calendar", calendar}},
                                      0.0));
  return file;
}

TEST_F(CfUnsaid, LeadTimesCountDaysOfTheFilesCalendar) {
  constexpr double kDay_s = 86'400.0;
  for (const auto& [calendar, last] :
       {std::pair{"noleap", "2000-03-02T00:00:00Z"}, std::pair{"standard", "2000-03-01T00:00:00Z"},
        std::pair{"julian", "2000-03-01T00:00:00Z"}}) {
    EXPECT_NE(MustRead(Forecast(calendar)), nullptr);
    ASSERT_EQ(info_.times.size(), 2U);
    EXPECT_EQ(info_.run_start, "2000-02-28T00:00:00Z");
    EXPECT_EQ(info_.times[1].valid_time, last) << calendar;
    EXPECT_EQ(info_.times[0].lead_s, kDay_s) << calendar;
    EXPECT_EQ(info_.times[1].lead_s, 2.0 * kDay_s) << calendar;
    EXPECT_EQ(info_.times[1].elapsed_s, kDay_s) << calendar;
  }
  // From 28 February to 1 March there are three days in a calendar of 30 days a month.
  SyntheticCf file = Forecast("360_day");
  file.coordinates.back().values = {3.0, 33.0};
  EXPECT_NE(MustRead(file), nullptr);
  EXPECT_EQ(info_.times[0].valid_time, "2000-03-01T00:00:00Z");
  EXPECT_EQ(info_.times[0].lead_s, 3.0 * kDay_s);
  EXPECT_EQ(info_.times[1].lead_s, 33.0 * kDay_s);
  EXPECT_EQ(info_.times[1].elapsed_s, 30.0 * kDay_s);
  // A reference time without a calendar counts in that of the times.
  file = Forecast("noleap");
  file.variables.back().attributes.erase("calendar");
  file.variables.back().attributes["units"] = "days since 1900-01-01";
  file.variables.back().value = [](const Index&) { return 100.0 * 365.0 + 58.0; };
  EXPECT_NE(MustRead(file), nullptr);
  EXPECT_EQ(info_.run_start, "2000-02-28T00:00:00Z");
  // With another calendar the start is not known, and this is said.
  file.variables.back().attributes["calendar"] = "360_day";
  EXPECT_NE(MustRead(file), nullptr);
  EXPECT_FALSE(info_.run_start.has_value());
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("The start of the run is not known")));
}

// In 2012 the common calendar has a 29 February, and noleap has none.
TEST_F(CfUnsaid, ElapsedTimesCountDaysOfTheFilesCalendar) {
  for (const auto& [calendar, days] : {std::pair{"noleap", 1.0}, std::pair{"standard", 2.0}}) {
    SyntheticCf file = Forecast(calendar);
    file.coordinates.back().attributes["units"] = "days since 2012-02-28";
    file.coordinates.back().values = {0.0, days};
    EXPECT_NE(MustRead(file), nullptr);
    ASSERT_EQ(info_.times.size(), 2U);
    EXPECT_EQ(info_.times[1].valid_time, "2012-03-01T00:00:00Z");
    EXPECT_EQ(info_.times[1].elapsed_s, 86'400.0 * days) << calendar;
  }
}

// Without a time, the valid time is the reference time and the period in the file's calendar.
TEST_F(CfUnsaid, PeriodsAreAddedInTheFilesCalendar) {
  SyntheticCf file = Forecast("noleap");
  file.coordinates.pop_back();
  file.variables[0].dimensions = {"z", "y", "x"};
  file.variables.push_back(
      OfOneValue("step", {}, {{"standard_name", "forecast_period"}, {"units", "hours"}}, 48.0));
  EXPECT_NE(MustRead(file), nullptr);
  EXPECT_EQ(info_.times[0].valid_time, "2000-03-02T00:00:00Z");
  EXPECT_EQ(info_.times[0].lead_s, 172'800.0);
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("calendar noleap")));
}

}  // namespace
}  // namespace thunderhead::storm_files
