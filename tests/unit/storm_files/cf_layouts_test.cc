// Tests of where a CF file's cells are. They cover heights of every kind, terrain in any layout,
// and places on Earth by coordinates and grid mappings. Other layouts are refused by name.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "storm_files/cf_names.h"
#include "tests/support/captured_log.h"
#include "tests/unit/storm_files/cf_file_test.h"

namespace thunderhead::storm_files {
namespace {

using testing::CfContent;
using ::testing::Contains;
using ::testing::HasSubstr;
using testing::Middles;
using testing::SyntheticCf;

class CfLayouts : public CfFileTest {};

// Returns cloud water of 1e-4 kg m-3 in the lowest of `layers` layers of 500 m, on 6 x 4 columns.
SyntheticCf Cloud(std::size_t layers = 4) {
  SyntheticCf file = testing::ExtinctionFile(6, 4, layers, 1000.0, 1000.0, 500.0, {});
  file.variables[0] = {"qc", {"z", "y", "x"}, {{"units", "kg m-3"}}, [](const Index& at) {
                         return at.at("z") == 0 ? 1e-4 : 0.0;
                       }};
  return file;
}

CfContent Values(const std::string& name, const std::vector<std::string>& on,
                 const std::string& units, std::function<double(const Index&)> value) {
  return {name, on, {{"units", units}}, std::move(value)};
}

// The height of the ground rises by 100 m from column to column eastwards, and by 10 m northwards.
double Ground_m(const Index& at) {
  return 100.0 * static_cast<double>(at.at("x")) + 10.0 * static_cast<double>(at.at("y"));
}

CfContent Terrain(const std::vector<std::string>& on) {
  CfContent terrain = Values("orog", on, "m", Ground_m);
  terrain.attributes["standard_name"] = "surface_altitude";
  return terrain;
}

TEST_F(CfLayouts, TerrainLiesInAnyOrderOfDimensions) {
  for (const std::vector<std::string>& on :
       {std::vector<std::string>{"y", "x"}, {"x", "y"}, {"time", "y", "x"}, {"x", "time", "y"}}) {
    SyntheticCf file = Cloud();
    file.coordinates.push_back({"time", {0.0}, {{"units", "hours since 2013-05-20"}}, {}});
    file.variables.push_back(Terrain(on));
    const auto fields = Read(file);
    ASSERT_TRUE(fields.ok()) << fields.status();
    for (std::size_t i = 0; i < 24; ++i) {
      EXPECT_FLOAT_EQ((*fields)->terrain_height_m[i],
                      static_cast<float>(Ground_m({{"x", i % 6}, {"y", i / 6}})));
    }
  }
}

TEST_F(CfLayouts, HeightIsAboveTheSurfaceAndAltitudeAboveSeaLevel) {
  SyntheticCf file = Cloud();
  // There is cloud in all layers up to 2 km. If their heights are altitudes, the lowest three
  // layers are below the ground.
  file.variables[0].value = [](const Index&) { return 1e-4; };
  file.variables.push_back(Terrain({"y", "x"}));
  file.variables.back().value = [](const Index&) { return 1500.0; };
  for (const auto& [name, low_m] : {std::pair{"altitude", 0.0}, {"height", 1500.0}}) {
    file.coordinates[2].attributes["standard_name"] = name;
    const auto fields = Read(file);
    ASSERT_TRUE(fields.ok()) << fields.status();
    EXPECT_DOUBLE_EQ((*fields)->grid.low_corner_m.z, low_m) << name;
    EXPECT_EQ((*fields)->condensate.low.z, name == std::string("height") ? 0 : 3);
  }
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("above the surface")));
  file.variables.pop_back();
  ASSERT_TRUE(Read(file).ok());
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("taken to be at sea level")));
}

TEST_F(CfLayouts, NumbersOfLevelsAreNoHeights) {
  for (const char* name : {"lev", "level", "height", "height_2", "generalVerticalLayer"}) {
    SyntheticCf file = Cloud();
    file.coordinates[2] = {name, {1.0, 2.0, 3.0, 4.0}, {{"axis", "Z"}, {"positive", "down"}}, {}};
    file.variables[0].dimensions[0] = name;
    file.variables[0].value = [](const Index&) { return 1e-4; };
    ExpectError(file, std::string("the vertical coordinate ") + name + " has no units");
    file.coordinates[2].attributes["units"] = "1";
    ExpectError(file, "HHL");
  }
  SyntheticCf file = Cloud();
  file.coordinates[2].attributes = {
      {"units", ""}, {"standard_name", "atmosphere_hybrid_sigma_pressure_coordinate"}};
  ExpectError(file, "atmosphere_hybrid_sigma_pressure_coordinate without usable formula_terms");
  file.coordinates[2].written = false;
  ExpectError(file, "z has no coordinate variable");
}

// Returns levels numbered from the top, as COSMO and ICON have them, with cloud in the lowest.
SyntheticCf FromTheTop() {
  SyntheticCf file = Cloud();
  file.coordinates[2] = {"z", {1.0, 2.0, 3.0, 4.0}, {{"axis", "Z"}, {"positive", "down"}}, {}};
  file.variables[0].value = [](const Index& at) { return at.at("z") == 3 ? 1e-4 : 0.0; };
  return file;
}

TEST_F(CfLayouts, HeightsAreThoseOfAnArrayOfFaces) {
  SyntheticCf file = FromTheTop();
  file.coordinates.push_back({"z_2", {1, 2, 3, 4, 5}, {{"axis", "Z"}, {"positive", "down"}}, {}});
  file.variables.push_back(Values("HHL", {"z_2", "y", "x"}, "m", [](const Index& at) {
    return Ground_m(at) + 400.0 * static_cast<double>(4 - at.at("z_2"));
  }));
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_NEAR((*fields)->grid.low_corner_m.z, 0.0, 1e-3);
  EXPECT_GE((*fields)->grid.HighCorner_m().z, 530.0 + 1600.0);
  // The ground is the lowest face, and each column has 400 m of cloud above it.
  EXPECT_NEAR((*fields)->terrain_height_m[5], 500.0F, 1e-3);
  const volume::FieldStatistics& statistics = (*fields)->fields[0].statistics;
  EXPECT_NEAR(statistics.mean_water_path_kg_per_m2, 0.04, 1e-6);
  EXPECT_NEAR(statistics.maximum_water_path_kg_per_m2, 0.04, 1e-6);
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("HHL")));
}

// A height that is a fill value, although no attribute declares this value, removes only its own
// layer.
TEST_F(CfLayouts, ImpossibleHeightsAreMissing) {
  for (const double impossible_m : {1e9, -1e9}) {
    SyntheticCf file = FromTheTop();
    file.coordinates.push_back({"z_2", {1, 2, 3, 4, 5}, {{"axis", "Z"}, {"positive", "down"}}, {}});
    file.variables[0].value = [](const Index&) { return 1e-4; };
    file.variables.push_back(Values("HHL", {"z_2", "y", "x"}, "m", [=](const Index& at) {
      const bool is_here = at.at("x") == 2 && at.at("y") == 1 && at.at("z_2") == 0;
      return is_here ? impossible_m : 400.0 * static_cast<double>(4 - at.at("z_2"));
    }));
    const auto fields = Read(file);
    ASSERT_TRUE(fields.ok()) << fields.status();
    EXPECT_LT((*fields)->grid.HighCorner_m().z, 2100.0);
    EXPECT_NEAR((*fields)->fields[0].statistics.maximum_water_path_kg_per_m2, 0.16, 1e-5);
    EXPECT_NEAR((*fields)->fields[0].statistics.mean_water_path_kg_per_m2, 0.16 - 0.04 / 24, 1e-5);
  }
}

TEST_F(CfLayouts, HeightsAreThoseOfAnArrayOfMiddles) {
  SyntheticCf file = FromTheTop();
  file.variables.push_back(Terrain({"y", "x"}));
  file.variables.push_back(Values("z_mc", {"z", "y", "x"}, "km", [](const Index& at) {
    return 1e-3 * (Ground_m(at) + 100.0 + 200.0 * static_cast<double>(3 - at.at("z")));
  }));
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_NEAR((*fields)->grid.low_corner_m.z, 0.0, 1e-3);
  EXPECT_NEAR((*fields)->fields[0].statistics.maximum_water_path_kg_per_m2, 0.02, 1e-5);
  // Heights without a standard name are taken as heights above the ground if they would lie below
  // the terrain as altitudes.
  file.variables.back() = Values("zhval", {"z", "y", "x"}, "m", [](const Index& at) {
    return 100.0 + 200.0 * static_cast<double>(3 - at.at("z"));
  });
  const auto above = Read(file);
  ASSERT_TRUE(above.ok()) << above.status();
  EXPECT_EQ((*above)->grid.cells, (*fields)->grid.cells);
  EXPECT_NEAR((*above)->fields[0].statistics.maximum_water_path_kg_per_m2, 0.02, 1e-5);
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("zhval are above the ground")));
}

// Layers of pressure that are below the ground hold no cloud.
TEST_F(CfLayouts, LayersBelowTheGroundAreEmpty) {
  SyntheticCf file = Cloud();
  file.coordinates[2] = {"z", {1000.0, 900.0, 800.0, 700.0}, {{"units", "hPa"}}, {}};
  file.variables[0].value = [](const Index&) { return 1e-4; };
  ExpectError(file, "holds pressures");
  ExpectError(file, "pressure levels need the geopotential height of each level");
  file.variables.push_back(Terrain({"y", "x"}));
  file.variables.back().value = [](const Index& at) { return at.at("x") < 3 ? 0.0 : 1000.0; };
  file.variables.push_back(Values("zg", {"z", "y", "x"}, "m", [](const Index& at) {
    return 250.0 + 500.0 * static_cast<double>(at.at("z"));
  }));
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_NEAR((*fields)->fields[0].statistics.maximum_water_path_kg_per_m2, 0.2, 1e-6);
  EXPECT_NEAR((*fields)->fields[0].statistics.mean_water_path_kg_per_m2, 0.15, 1e-6);
}

// In air of 287 K at rest, heights rise by R T / g ln(p / p_above) from level to level.
TEST_F(CfLayouts, HeightsOfPressureLevelsFollowFromTheGround) {
  constexpr double kScale_m = 287.06 * 287.0 / 9.80665;
  SyntheticCf file = Cloud();
  // The pressure of the ground is that at 500 m, if it is 1000 hPa at sea level.
  const double ground_Pa = 1e5 * std::exp(-500.0 / kScale_m);
  for (const bool upwards : {true, false}) {
    file = Cloud();
    std::vector<double> levels_hPa = {1000.0, 900.0, 800.0, 700.0};
    if (!upwards) std::ranges::reverse(levels_hPa);
    file.coordinates[2] = {"z", levels_hPa, {{"units", "hPa"}}, {}};
    const auto level = [upwards](const Index& at) { return upwards ? at.at("z") : 3 - at.at("z"); };
    file.variables[0].value = [level](const Index& at) { return level(at) == 1 ? 1e-4 : 0.0; };
    file.variables.push_back(Terrain({"y", "x"}));
    file.variables.back().value = [](const Index&) { return 500.0; };
    file.variables.push_back(
        Values("ps", {"y", "x"}, "hPa", [=](const Index&) { return ground_Pa / 100.0; }));
    ExpectError(file, "lacks air_temperature");
    // The level below the ground has no temperature.
    file.variables.push_back(Values("t", {"z", "y", "x"}, "K", [level](const Index& at) {
      return level(at) == 0 ? std::nan("") : 287.0;
    }));
    const auto fields = Read(file);
    ASSERT_TRUE(fields.ok()) << fields.status();
    // The layer of 900 hPa reaches from the ground half-way up to 800 hPa.
    const double top_m = 0.5 * kScale_m * (std::log(1000.0 / 900.0) + std::log(1000.0 / 800.0));
    EXPECT_NEAR((*fields)->fields[0].statistics.maximum_water_path_kg_per_m2,
                1e-4 * (top_m - 500.0), 1e-4);
    EXPECT_NEAR((*fields)->grid.low_corner_m.z, 500.0, 1.0);
    EXPECT_THAT(info_.assumptions, Contains(HasSubstr("The heights of the levels z follow from "
                                                      "temperature and humidity")));
  }
  // Without the pressure of the ground, the error says what is needed.
  std::erase_if(file.variables, [](const CfContent& variable) { return variable.name == "ps"; });
  ExpectError(file, "surface_altitude and surface_air_pressure");
}

// The Unified Model's layers: z = a + b * orography.
TEST_F(CfLayouts, HybridHeightsFollowFromTheirFormula) {
  SyntheticCf file = Cloud(2);
  file.coordinates[2] = {"z", {1.0, 2.0}, {{"units", "1"}, {"axis", "Z"}}, {}};
  file.variables.push_back(Terrain({"y", "x"}));
  file.variables.push_back(Values("level_height", {"z"}, "m", [](const Index& at) {
    return at.at("z") == 0 ? 500.0 : 1500.0;
  }));
  file.variables.back().attributes["standard_name"] = "atmosphere_hybrid_height_coordinate";
  file.variables.back().attributes["formula_terms"] = "a: level_height b: sigma orog: orog";
  file.variables.push_back(
      Values("sigma", {"z"}, "1", [](const Index& at) { return at.at("z") == 0 ? 0.75 : 0.25; }));
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  // The lowest layer reaches from the ground to half-way between the layers: 1000 m + 0.5 ground.
  EXPECT_NEAR((*fields)->fields[0].statistics.maximum_water_path_kg_per_m2, 1e-4 * 1000.0, 1e-6);
  EXPECT_NEAR((*fields)->fields[0].statistics.mean_water_path_kg_per_m2,
              1e-4 * (1000.0 - 0.5 * 265.0), 1e-6);
  // Layers that begin far above the ground do not reach it.
  SyntheticCf high = file;
  for (CfContent& variable : high.variables) {
    if (variable.name != "level_height") continue;
    variable.value = [](const Index& at) { return at.at("z") == 0 ? 5500.0 : 6500.0; };
  }
  const auto high_fields = Read(high);
  ASSERT_TRUE(high_fields.ok()) << high_fields.status();
  EXPECT_NEAR((*high_fields)->fields[0].statistics.maximum_water_path_kg_per_m2, 1e-4 * 1000.0,
              1e-6);
  EXPECT_GT((*high_fields)->grid.low_corner_m.z, 4900.0);
  file.variables.erase(file.variables.begin() + 1);
  ExpectError(file, "needs the formula term orog (orog)");
}

// iris writes the Unified Model's terms also without formula_terms.
TEST_F(CfLayouts, HybridHeightsFollowFromTheNamesOfIris) {
  SyntheticCf file = Cloud(2);
  file.coordinates[2] = {
      "z", {1.0, 2.0}, {{"units", "1"}, {"standard_name", "model_level_number"}}, {}};
  ExpectError(file, "the Unified Model writes level_height, sigma and surface_altitude");
  file.variables.push_back(Values("level_height", {"z"}, "m", [](const Index& at) {
    return at.at("z") == 0 ? 500.0 : 1500.0;
  }));
  file.variables.push_back(
      Values("sigma", {"z"}, "1", [](const Index& at) { return at.at("z") == 0 ? 0.75 : 0.25; }));
  ExpectError(file, "needs the formula term orog (surface_altitude)");
  file.variables.push_back(Terrain({"y", "x"}));
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  // The same as with formula_terms, above.
  EXPECT_NEAR((*fields)->fields[0].statistics.maximum_water_path_kg_per_m2, 1e-4 * 1000.0, 1e-6);
  EXPECT_NEAR((*fields)->fields[0].statistics.mean_water_path_kg_per_m2,
              1e-4 * (1000.0 - 0.5 * 265.0), 1e-6);
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("follow from level_height and the terrain")));
  // Without units, the terms could be anything.
  for (CfContent& variable : file.variables) {
    if (variable.name == "level_height") variable.attributes.erase("units");
  }
  ExpectError(file, "holds numbers of levels");
}

// The error begins with its cause. A file of numbered levels may need another file with heights.
TEST_F(CfLayouts, TheCauseOfARefusalComesFirst) {
  SyntheticCf file = Cloud(2);
  file.coordinates[2] = {
      "lev", {0.9, 0.8}, {{"units", "1"}, {"standard_name", "atmosphere_sigma_coordinate"}}, {}};
  file.variables[0].dimensions = {"lev", "y", "x"};
  file.variables[0].value = [](const Index&) { return 1e-4; };
  const auto fields = Read(file);
  ASSERT_FALSE(fields.ok());
  const std::string message(fields.status().message());
  EXPECT_THAT(message, ::testing::StartsWith(
                           path_ + ": the vertical coordinate lev holds values of "
                                   "atmosphere_sigma_coordinate without usable formula_terms"));
  EXPECT_THAT(message, ::testing::Not(HasSubstr("COSMO")));
  EXPECT_THAT(message, ::testing::EndsWith("If the file is one of several files of a time, give "
                                           "the folder with all of them"));
}

// In air of 280 K at rest, a layer is R T / g ln(p_below / p_above) thick.
TEST_F(CfLayouts, HybridPressuresGiveHydrostaticHeights) {
  SyntheticCf file = FromTheTop();
  file.coordinates[2].attributes = {
      {"units", "1"},
      {"standard_name", "atmosphere_hybrid_sigma_pressure_coordinate"},
      {"formula_terms", "ap: ap b: b ps: ps"}};
  file.coordinates[2].values = {0.3, 0.5, 0.7, 0.9};
  file.variables[0].attributes["units"] = "kg kg-1";
  file.variables.push_back(Values("ap", {"z"}, "hPa", [](const Index&) { return 10.0; }));
  file.variables.push_back(Values("b", {"z"}, "1", [](const Index& at) {
    return 0.3 + 0.2 * static_cast<double>(at.at("z"));
  }));
  file.variables.push_back(Values("ps", {"y", "x"}, "hPa", [](const Index&) { return 1000.0; }));
  ExpectError(file, "lacks air_temperature");
  file.variables.push_back(Values("ta", {"z", "y", "x"}, "K", [](const Index&) { return 280.0; }));
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  // The lowest layer reaches from the surface at 1000 hPa to 10 + 800 hPa.
  const double thick_m = 287.0 * 280.0 / 9.80665 * std::log(1000.0 / 810.0);
  const double density = (10.0 + 0.9 * 1000.0) * 100.0 / (287.0 * 280.0);
  EXPECT_NEAR((*fields)->fields[0].statistics.maximum_water_path_kg_per_m2,
              1e-4 * thick_m * density, 1e-3 * 1e-4 * thick_m * density);
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("hydrostatic")));
  for (CfContent& variable : file.variables) {
    if (variable.name != "b") continue;
    variable.value = [](const Index& at) { return 0.1 + 0.1 * static_cast<double>(at.at("z")); };
  }
  ExpectError(file, "begins far above the ground");
}

// Returns the cloud on longitudes and latitudes.
SyntheticCf InDegrees(std::vector<double> longitudes, std::vector<double> latitudes) {
  SyntheticCf file = Cloud();
  file.coordinates[0] = {"lon", std::move(longitudes), {{"units", "degrees_east"}}, {}};
  file.coordinates[1] = {"lat", std::move(latitudes), {{"units", "degrees_north"}}, {}};
  file.variables[0].dimensions = {"z", "lat", "lon"};
  return file;
}

TEST_F(CfLayouts, LongitudesMayWrap) {
  SyntheticCf file =
      InDegrees({359.97, 359.98, 359.99, 0.0, 0.01, 0.02}, {51.0, 51.01, 51.02, 51.03});
  ASSERT_TRUE(Read(file).ok());
  EXPECT_NEAR(info_.longitude_deg.value(), -0.005, 1e-9);
  file = InDegrees({179.98, 179.99, -180.0, -179.99, -179.98, -179.97}, {0.0, 0.01, 0.02, 0.03});
  ASSERT_TRUE(Read(file).ok());
  EXPECT_NEAR(info_.longitude_deg.value(), -179.995, 1e-9);
  file = InDegrees({262.5, 262.51, 262.52, 262.53, 262.54, 262.55}, {0.03, 0.02, 0.01, 0.0});
  ASSERT_TRUE(Read(file).ok());
  EXPECT_NEAR(info_.longitude_deg.value(), 262.525 - 360.0, 1e-9);
}

TEST_F(CfLayouts, BoundsTakePrecedenceOverCoordinates) {
  // The coordinates are the south-western corners of the cells.
  SyntheticCf file =
      InDegrees({359.98, 359.99, 0.0, 0.01, 0.02, 0.03}, {51.0, 51.01, 51.02, 51.03});
  file.coordinates[0].faces = {359.98, 359.99, 0.0, 0.01, 0.02, 0.03, 0.04};
  file.coordinates[1].faces = {51.0, 51.01, 51.02, 51.03, 51.04};
  ASSERT_TRUE(Read(file).ok());
  EXPECT_NEAR(info_.longitude_deg.value(), 0.01, 1e-9);
  EXPECT_NEAR(info_.latitude_deg.value(), 51.02, 1e-9);
  file = Cloud();
  file.coordinates[2].values = {0.0, 100.0, 400.0, 1000.0};
  file.coordinates[2].faces = {0.0, 100.0, 400.0, 1000.0, 2000.0};
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_NEAR((*fields)->fields[0].statistics.mean_water_path_kg_per_m2, 1e-4 * 100.0, 1e-8);
  EXPECT_GE((*fields)->grid.HighCorner_m().z, 2000.0);
}

// After the test has followed the advice in the error message, the file must be readable.
TEST_F(CfLayouts, AnotherDimensionIsRefusedWithARemedyThatWorks) {
  SyntheticCf file = Cloud();
  SyntheticCf scenarios = file;
  scenarios.variables[0].dimensions.insert(scenarios.variables[0].dimensions.begin(), "scenario");
  scenarios.coordinates.push_back({"scenario", {0.0, 1.0, 2.0}, {}, {}});
  ExpectError(scenarios, "has a dimension scenario of 3 in addition to x, y, z and time");
  ExpectError(scenarios, "for example with ncks -d scenario,0 in.nc out.nc");
  scenarios.coordinates.back().values.resize(1);
  EXPECT_TRUE(Read(scenarios).ok()) << Read(scenarios).status();
  // The additional dimension may also be one of x, y and z under an unknown name.
  file.coordinates[2].name = "storey";
  file.coordinates[2].attributes.erase("axis");
  file.coordinates[2].attributes.erase("positive");
  file.coordinates[2].attributes.erase("standard_name");
  file.coordinates[2].attributes["units"] = "m";
  std::ranges::replace(file.variables[0].dimensions, std::string("z"), std::string("storey"));
  file.variables[0].value = [](const Index&) { return 1e-4; };
  ExpectError(file,
              "if storey is x, y, z or time, give its coordinate variable the attribute axis");
  file.coordinates[2].attributes["axis"] = "Z";
  EXPECT_TRUE(Read(file).ok()) << Read(file).status();
}

// Adds a grid mapping to the cloud.
void AddMapping(SyntheticCf& file, const std::map<std::string, std::string>& texts,
                const std::map<std::string, double>& numbers) {
  file.variables.push_back({"crs", {}, texts, [](const Index&) { return 0.0; }});
  file.number_attributes["crs"] = numbers;
  file.variables[0].attributes["grid_mapping"] = "crs";
}

// The expected place is that of the rotation's formulas (pole at 43 N, 172 W): rlon 10, rlat 5.
TEST_F(CfLayouts, RotatedGridsHaveTheirPlace) {
  SyntheticCf file = Cloud();
  file.coordinates[0] = {"rlon",
                         Middles(6, 9.97, 0.01),
                         {{"units", "degrees"}, {"standard_name", "grid_longitude"}},
                         {}};
  file.coordinates[1] = {"rlat",
                         Middles(4, 4.98, 0.01),
                         {{"units", "degrees"}, {"standard_name", "grid_latitude"}},
                         {}};
  file.variables[0].dimensions = {"z", "rlat", "rlon"};
  ASSERT_TRUE(Read(file).ok());
  EXPECT_FALSE(info_.latitude_deg.has_value());
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("place is not known")));
  AddMapping(file, {{"grid_mapping_name", "rotated_latitude_longitude"}},
             {{"grid_north_pole_latitude", 43.0}, {"grid_north_pole_longitude", -172.0}});
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_NEAR(info_.latitude_deg.value(), 50.98145, 1e-3);
  EXPECT_NEAR(info_.longitude_deg.value(), 23.94830, 1e-3);
  EXPECT_NEAR((*fields)->grid.spacing_m.y, 1111.95, 0.5);
  EXPECT_NEAR((*fields)->grid.spacing_m.x, 1111.95 * std::cos(5.0 * M_PI / 180.0), 0.5);
  // Either the mapping alone or the names of the axes alone suffice to show that the axes are
  // rotated.
  for (testing::CfCoordinate* axis : {&file.coordinates[0], &file.coordinates[1]}) {
    axis->attributes.erase("standard_name");
  }
  ASSERT_TRUE(Read(file).ok());
  EXPECT_NEAR(info_.latitude_deg.value(), 50.98145, 1e-3);
  SyntheticCf unmapped = file;
  unmapped.variables[0].attributes.erase("grid_mapping");
  ASSERT_TRUE(Read(unmapped).ok());
  EXPECT_FALSE(info_.latitude_deg.has_value());
  file.number_attributes["crs"].erase("grid_north_pole_latitude");
  ExpectError(file, "the grid mapping crs has no attribute grid_north_pole_latitude");
}

// A Mercator map with true scale at 0 N is twice too large at 60 N.
TEST_F(CfLayouts, DistancesOnAMapAreTrueDistances) {
  SyntheticCf file = Cloud();
  const double north_m = 6371000.0 * std::log(std::tan(M_PI / 4 + 30.0 * M_PI / 180.0));
  file.coordinates[0] = {"x",
                         Middles(6, -6.0, 2.0),
                         {{"units", "km"}, {"standard_name", "projection_x_coordinate"}},
                         {}};
  file.coordinates[1] = {"y",
                         Middles(4, 1e-3 * north_m - 4.0, 2.0),
                         {{"units", "km"}, {"standard_name", "projection_y_coordinate"}},
                         {}};
  AddMapping(file, {{"grid_mapping_name", "mercator"}},
             {{"standard_parallel", 0.0},
              {"longitude_of_projection_origin", 10.0},
              {"earth_radius", 6371000.0}});
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_NEAR(info_.latitude_deg.value(), 60.0, 1e-3);
  EXPECT_NEAR(info_.longitude_deg.value(), 10.0, 1e-3);
  EXPECT_NEAR((*fields)->grid.spacing_m.x, 1000.0, 2.0);
  EXPECT_NEAR((*fields)->grid.spacing_m.y, 1000.0, 2.0);
}

// The columns of an ocean stay on its Mercator map. Distances are true in the middle, at 30 N,
// where the map factor is 1.1547.
TEST_F(CfLayouts, AWideDomainStaysOnItsConformalMap) {
  SyntheticCf file = Cloud();
  const double north_m = 6371000.0 * std::log(std::tan(M_PI / 4 + 15.0 * M_PI / 180.0));
  file.coordinates[0].values = Middles(6, -2.4e6, 8e5);
  file.coordinates[1].values = Middles(4, north_m - 8e5, 4e5);
  for (const int axis : {0, 1}) {
    file.coordinates[axis].attributes = {
        {"units", "m"},
        {"standard_name", axis == 0 ? "projection_x_coordinate" : "projection_y_coordinate"}};
  }
  AddMapping(file, {{"grid_mapping_name", "mercator"}},
             {{"standard_parallel", 0.0},
              {"longitude_of_projection_origin", 170.0},
              {"earth_radius", 6371000.0}});
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ((*fields)->grid.cells.x, 6);
  EXPECT_EQ((*fields)->grid.cells.y, 4);
  EXPECT_NEAR((*fields)->grid.spacing_m.x, 8e5 * std::cos(M_PI / 6.0), 0.003 * 8e5);
  EXPECT_NEAR((*fields)->grid.spacing_m.y, 4e5 * std::cos(M_PI / 6.0), 0.003 * 4e5);
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("true in the middle, and 9")));
  // The centre of the last column, by the formulas of the map.
  const auto map = storm_store::ProjectionOf(info_, 0);
  ASSERT_TRUE(map.has_value());
  const glm::dvec2 corner_m =
      glm::dvec2((*fields)->grid.HighCorner_m()) - 0.5 * glm::dvec2((*fields)->grid.spacing_m);
  const auto place = map->PlaceOf(corner_m);
  ASSERT_TRUE(place.has_value());
  const double latitude = 2.0 * std::atan(std::exp((north_m + 6e5) / 6371000.0)) - M_PI / 2.0;
  EXPECT_NEAR(place->latitude_deg, latitude * 180.0 / M_PI, 0.01);
  EXPECT_NEAR(place->longitude_deg, 170.0 + 2.0e6 / 6371000.0 * 180.0 / M_PI - 360.0, 0.01);
}

// On WGS 84 a degree of latitude at the equator is 110 574 m. On a sphere it is 111 195 m.
TEST_F(CfLayouts, DegreesAreOfTheFileOwnEllipsoid) {
  SyntheticCf file = InDegrees({10.0, 10.1, 10.2, 10.3, 10.4, 10.5}, {0.0, 0.1, 0.2, 0.3});
  auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_NEAR((*fields)->grid.spacing_m.y, 11'119.5, 3.0);
  AddMapping(file, {{"grid_mapping_name", "latitude_longitude"}},
             {{"semi_major_axis", 6378137.0}, {"inverse_flattening", 298.257223563}});
  fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_NEAR((*fields)->grid.spacing_m.y, 11'057.4, 3.0);
  EXPECT_NEAR((*fields)->grid.spacing_m.x, 11'131.9, 3.0);
}

// Adds longitudes and latitudes of a grid of 0.01 degrees, whose middle is at 47 N 8 E.
void AddPlaces(SyntheticCf& file, const std::string& y, const std::string& x) {
  file.variables.push_back(Values("lat", {y, x}, "degrees_north", [y](const Index& at) {
    return 47.0 + 0.01 * (static_cast<double>(at.at(y)) - 1.5);
  }));
  file.variables.push_back(Values("lon", {y, x}, "degrees_east", [x](const Index& at) {
    return 8.0 + 0.01 * (static_cast<double>(at.at(x)) - 2.5);
  }));
}

TEST_F(CfLayouts, LongitudesAndLatitudesOfEachColumnAreEnough) {
  SyntheticCf file = Cloud();
  AddPlaces(file, "y", "x");
  ASSERT_TRUE(Read(file).ok());
  // The columns' own map projection places coasts.
  EXPECT_THAT(info_.projection, HasSubstr("+proj="));
  EXPECT_NEAR(info_.latitude_deg.value(), 47.0, 1e-4);
  EXPECT_NEAR(info_.longitude_deg.value(), 8.0, 1e-4);
  // The dimensions have names without meaning and no coordinates.
  file = Cloud();
  file.coordinates[0] = {"b", std::vector<double>(6), {}, {}, false};
  file.coordinates[1] = {"a", std::vector<double>(4), {}, {}, false};
  file.variables[0].dimensions = {"z", "a", "b"};
  AddPlaces(file, "a", "b");
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ((*fields)->grid.cells, glm::ivec3(6, 4, 4));
  EXPECT_NEAR((*fields)->grid.spacing_m.y, 1111.95, 1.0);
  EXPECT_NEAR((*fields)->grid.spacing_m.x, 1111.95 * std::cos(47.0 * M_PI / 180.0), 1.0);
  EXPECT_NEAR(info_.longitude_deg.value(), 8.0, 1e-4);
}

TEST_F(CfLayouts, ColumnsThatRunSouthAreTurned) {
  SyntheticCf file = Cloud();
  file.coordinates[0] = {"b", std::vector<double>(6), {}, {}, false};
  file.coordinates[1] = {"a", std::vector<double>(4), {}, {}, false};
  file.variables[0].dimensions = {"z", "a", "b"};
  file.variables[0].value = [](const Index& at) {
    return at.at("a") == 0 && at.at("z") == 0 ? 1e-4 : 0.0;
  };
  AddPlaces(file, "a", "b");
  file.variables[1].value = [](const Index& at) {
    return 47.0 - 0.01 * (static_cast<double>(at.at("a")) - 1.5);
  };
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ((*fields)->condensate.low.y, 3);
}

TEST_F(CfLayouts, ColumnsWithoutPlacesOrAreaAreRefusedByName) {
  SyntheticCf file = Cloud();
  file.coordinates[0] = {"cell", std::vector<double>(6), {}, {}, false};
  file.variables[0].dimensions = {"z", "cell"};
  ExpectError(file, "cells 'cell' of an unstructured grid");
  file.coordinates[0].name = "ncol";
  file.variables[0].dimensions = {"z", "ncol"};
  ExpectError(file, "points 'ncol' of spectral elements");
  file.coordinates[0].name = "column";
  file.variables[0].dimensions = {"z", "column"};
  file.variables.push_back(Values("lat", {"column"}, "degrees_north", [](const Index& at) {
    return static_cast<double>(at.at("column"));
  }));
  file.variables.push_back(
      Values("lon", {"column"}, "degrees_east", [](const Index&) { return 5.0; }));
  ExpectError(file, "the cells lie on one line, so the domain has no area");
}

// CM1 names its dimensions ni, nj and nk, and its wind lies on the faces between cells.
TEST_F(CfLayouts, WindOnFacesIsAveraged) {
  SyntheticCf file = Cloud();
  file.coordinates[0] = {"ni", std::vector<double>(6), {}, {}, false};
  file.coordinates[1] = {"nj", std::vector<double>(4), {}, {}, false};
  file.coordinates[2] = {"nk", std::vector<double>(4), {}, {}, false};
  for (const char* name : {"nip1", "njp1", "nkp1"}) {
    const std::size_t length = name[1] == 'i' ? 7 : 5;
    file.coordinates.push_back({name, std::vector<double>(length), {}, {}, false});
  }
  file.variables[0].dimensions = {"nk", "nj", "ni"};
  file.variables[0].value = [](const Index& at) { return at.at("nk") == 0 ? 1e-4 : 0.0; };
  const auto along = [](const std::string& name, const std::string& dimension, double step) {
    return Values(name, {dimension}, "km", [=](const Index& at) {
      return step * (0.5 + static_cast<double>(at.at(dimension)));
    });
  };
  file.variables.push_back(along("xh", "ni", 1.0));
  file.variables.push_back(along("yh", "nj", 1.0));
  file.variables.push_back(along("z", "nk", 0.5));
  file.variables.push_back(along("xf", "nip1", 1.0));
  file.variables.push_back(along("yf", "njp1", 1.0));
  file.variables.push_back(along("zf", "nkp1", 0.5));
  file.variables.push_back(Values("u", {"nk", "nj", "nip1"}, "m/s", [](const Index& at) {
    return static_cast<double>(at.at("nip1"));
  }));
  file.variables.push_back(
      Values("v", {"nk", "njp1", "ni"}, "m/s", [](const Index&) { return -3.0; }));
  file.variables.push_back(Values("w", {"nkp1", "nj", "ni"}, "m/s", [](const Index& at) {
    return static_cast<double>(at.at("nkp1"));
  }));
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ((*fields)->grid.spacing_m, glm::dvec3(1000.0, 1000.0, 500.0));
  EXPECT_EQ((*fields)->motion.source, volume::TurbulenceSource::kDeformation);
  EXPECT_EQ((*fields)->motion.steering_m_per_s, glm::dvec2(3.0, -3.0));
  EXPECT_EQ((*fields)->motion.ascent[0], 2);  // 0.5 m/s in units of 0.25 m/s
}

// An anelastic model gives the density of its base state as a profile.
TEST_F(CfLayouts, TheAirMayBeAProfile) {
  SyntheticCf file = Cloud();
  file.variables[0].attributes["units"] = "g/kg";
  file.variables[0].value = [](const Index& at) { return at.at("z") == 0 ? 0.5 : 0.0; };
  file.variables.push_back(Values("rhobf", {"z"}, "kg m-3", [](const Index& at) {
    return 1.2 - 0.1 * static_cast<double>(at.at("z"));
  }));
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_FLOAT_EQ((*fields)->fields[0].concentration_kg_per_m3[0], 0.5e-3F * 1.2F);
  file.variables.back() = Values("PP", {"z", "y", "x"}, "Pa", [](const Index&) { return 10.0; });
  ExpectError(file, "PP is only the deviation from a reference state");
}

}  // namespace
}  // namespace thunderhead::storm_files
