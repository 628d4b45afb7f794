// Tests of which water of a CF file is shown. Water in a form that is not shown is named, with the
// reason. Also tests what is said of the air to which mixing ratios belong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <tuple>

#include "tests/unit/storm_files/cf_file_test.h"

namespace thunderhead::storm_files {
namespace {

using physics::Hydrometeor;
using testing::CfContent;
using ::testing::Contains;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::SyntheticCf;

constexpr double kWaterLayer_m = 500.0;
constexpr double kWaterPressure_Pa = 80'000.0;
constexpr double kWaterGas_J_per_kg_K = 287.0;

// Returns an amount of water of `value` in all cells.
CfContent WaterOf(const std::string& name, const std::string& standard_name, double value,
                  const std::string& units = "kg kg-1") {
  Texts attributes = {{"units", units}};
  if (!standard_name.empty()) attributes["standard_name"] = standard_name;
  return OfOneValue(name, {"z", "y", "x"}, std::move(attributes), value);
}

// Returns four layers of air at 80 000 Pa and `temperature_K`, and water.
SyntheticCf AirWith(std::vector<CfContent> water, double temperature_K = 287.0) {
  SyntheticCf file = testing::ExtinctionFile(6, 4, 4, 1000.0, 1000.0, kWaterLayer_m, {});
  file.variables = std::move(water);
  file.variables.push_back(OfOneValue("p", {"z", "y", "x"},
                                      {{"units", "Pa"}, {"standard_name", "air_pressure"}},
                                      kWaterPressure_Pa));
  file.variables.push_back(OfOneValue(
      "t", {"z", "y", "x"}, {{"units", "K"}, {"standard_name", "air_temperature"}}, temperature_K));
  return file;
}

// Returns the water path of a mixing ratio in the four layers.
double PathOf(double ratio, double temperature_K = 287.0) {
  return ratio * 4.0 * kWaterLayer_m * kWaterPressure_Pa / (kWaterGas_J_per_kg_K * temperature_K);
}

class CfWater : public CfFileTest {
 protected:
  // Expects exactly these fields, with these water paths.
  void ExpectPaths(const SyntheticCf& file, const std::map<Hydrometeor, double>& paths_kg_per_m2) {
    const auto fields = Read(file);
    ASSERT_TRUE(fields.ok()) << fields.status();
    std::map<Hydrometeor, double> read;
    for (const volume::HydrometeorField& field : (*fields)->fields) {
      read[field.hydrometeor] = field.statistics.maximum_water_path_kg_per_m2;
    }
    ASSERT_EQ(read.size(), paths_kg_per_m2.size());
    for (const auto& [hydrometeor, path] : paths_kg_per_m2) {
      EXPECT_NEAR(read[hydrometeor], path, 2e-3 * path) << physics::NameOf(hydrometeor);
    }
  }

  void ExpectSaid(const std::string& assumption) {
    EXPECT_THAT(info_.assumptions, Contains(HasSubstr(assumption)));
  }
};

// iris gives each variable its standard name as the name.
TEST_F(CfWater, AStandardNameMayBeTheName) {
  const std::string cloud = "mass_fraction_of_cloud_liquid_water_in_air";
  const std::string rain = "mass_fraction_of_rain_in_air";
  // 1 kg of the whole air has 0.999 kg of dry air.
  ExpectPaths(AirWith({WaterOf(cloud, cloud, 1e-3)}),
              {{Hydrometeor::kCloud, PathOf(1e-3) / 0.999}});
  ExpectPaths(AirWith({WaterOf(cloud, cloud, 1e-3), WaterOf("qr", "", 1e-4)}),
              {{Hydrometeor::kCloud, PathOf(1e-3) / 0.999}, {Hydrometeor::kRain, PathOf(1e-4)}});
  ExpectPaths(
      AirWith({WaterOf(cloud, "", 1e-3), WaterOf(rain, "unknown", 1e-3)}),
      {{Hydrometeor::kCloud, PathOf(1e-3) / 0.998}, {Hydrometeor::kRain, PathOf(1e-3) / 0.998}});
  ExpectPaths(AirWith({WaterOf("mass_concentration_of_snow_in_air",
                               "mass_concentration_of_snow_in_air", 1e-3, "kg m-3")}),
              {{Hydrometeor::kSnow, 2.0}});
  // The air's variables may have such names, too. Of 1 kg of the whole air, 0.01 kg is vapour.
  SyntheticCf file = AirWith({WaterOf(cloud, "", 1e-3), WaterOf("specific_humidity", "", 0.01)});
  const double vapour = 0.01 / 0.99;  // per kg of dry air
  const double with_vapour = PathOf(1e-3) / 0.999 * (1.0 + vapour) / (1.0 + 1.608 * vapour);
  for (CfContent& variable : file.variables) {
    variable.attributes.erase("standard_name");
    if (variable.name == "p") variable.name = "air_pressure";
    if (variable.name == "t") variable.name = "air_temperature";
  }
  ExpectPaths(file, {{Hydrometeor::kCloud, with_vapour}});
  ExpectSaid(cloud + " is per kg of the whole air (dry air, vapour and condensate), by the name.");
  // ICON repeats its own names.
  ExpectPaths(AirWith({WaterOf("qc", "qc", 1e-3)}), {{Hydrometeor::kCloud, PathOf(1e-3)}});
}

TEST_F(CfWater, CondensedWaterIsCloudWaterNextToCloudIce) {
  const std::string condensed = "mass_fraction_of_cloud_condensed_water_in_air";
  const CfContent ice = WaterOf("ice_ml", "mass_concentration_of_cloud_ice_in_air", 1e-5, "kg m-3");
  CfContent water = WaterOf("cloud_ml", condensed, 1e-3);
  water.attributes["units"] = "kg m-3";
  ExpectPaths(AirWith({water, ice}, 263.16),
              {{Hydrometeor::kCloud, 2.0}, {Hydrometeor::kIce, 0.02}});
  ExpectSaid("cloud_ml is taken as cloud water alone, because ice_ml is the cloud ice.");
  // Alone, it is divided by temperature. At 263.16 K, half of it is liquid.
  ExpectPaths(AirWith({water}, 263.16), {{Hydrometeor::kCloud, 1.0}, {Hydrometeor::kIce, 1.0}});
  ExpectSaid("cloud_ml is divided into cloud water and ice by temperature");
  // With cloud water, it says nothing new.
  ExpectPaths(AirWith({water, WaterOf("qc", "", 5e-4, "kg m-3")}), {{Hydrometeor::kCloud, 1.0}});
  ExpectSaid("cloud_ml is left out, because the file also has the hydrometeors in it.");
  // A second variable of the same kind is not added to the first.
  CfContent again = water;
  again.name = "again";
  ExpectPaths(AirWith({water, again}, 263.16),
              {{Hydrometeor::kCloud, 1.0}, {Hydrometeor::kIce, 1.0}});
  ExpectSaid("again is left out");
  ExpectPaths(AirWith({water, again, ice}),
              {{Hydrometeor::kCloud, 2.0}, {Hydrometeor::kIce, 0.02}});
  // A usual name with this standard name is the same.
  water.name = "qc";
  ExpectPaths(AirWith({water, ice}), {{Hydrometeor::kCloud, 2.0}, {Hydrometeor::kIce, 0.02}});
}

TEST_F(CfWater, PrecipitationIsDividedByTemperature) {
  const CfContent all =
      WaterOf("precipitation", "mass_fraction_of_precipitation_in_air", 1e-3, "kg m-3");
  const CfContent cloud = WaterOf("qc", "", 1e-3, "kg m-3");
  ExpectPaths(AirWith({cloud, all}, 290.0), {{Hydrometeor::kCloud, 2.0},
                                             {Hydrometeor::kRain, 2.0},
                                             {Hydrometeor::kSnow, 0.0},
                                             {Hydrometeor::kGraupel, 0.0}});
  ExpectSaid("precipitation is divided into rain, snow and graupel");
}

TEST_F(CfWater, WaterThatIsNotShownIsNamed) {
  const CfContent rain = WaterOf("qr", "", 1e-3, "kg m-3");
  const std::string convective = "mass_fraction_of_convective_cloud_liquid_water_in_air";
  for (const auto& [name, standard_name, units] :
       {std::tuple{"conv", convective.c_str(), "kg kg-1"},
        std::tuple{"qc", "some_other_water", "kg m-3"},
        std::tuple{"total", "mass_fraction_of_water_in_air", "1"},
        std::tuple{"layer", "mass_content_of_cloud_ice_in_atmosphere_layer", "kg m-2"}}) {
    ExpectPaths(AirWith({rain, WaterOf(name, standard_name, 1e-3, units)}),
                {{Hydrometeor::kRain, 2.0}});
    ExpectSaid(std::string(name) + " is left out, because its standard name " + standard_name +
               " is not that of a hydrometeor that is shown.");
  }
  CfContent drizzle = WaterOf("dz", "", 1e-3, "g/kg");
  drizzle.attributes["long_name"] = "Drizzle mixing ratio";
  CfContent condensate = WaterOf("TOT", "", 1e-3, "g m-3");
  condensate.attributes["long_name"] = "total specific cloud water content (diagnostic)";
  for (const CfContent& other : {drizzle, condensate, WaterOf("qt", "", 1e-3, "g/kg"),
                                 WaterOf("cloud_and_rain", "", 1e-3, "g/kg")}) {
    ExpectPaths(AirWith({rain, other}), {{Hydrometeor::kRain, 2.0}});
    ExpectSaid(other.name + " is left out, because its name is not that of a hydrometeor");
  }
  // Size bins have one more dimension.
  SyntheticCf file = AirWith({rain});
  file.coordinates.push_back({"bin", {1.0, 2.0, 3.0}, {}, {}});
  file.variables.push_back(WaterOf("bins", convective, 1e-3));
  file.variables.back().dimensions = {"bin", "z", "y", "x"};
  ExpectPaths(file, {{Hydrometeor::kRain, 2.0}});
  ExpectSaid("bins is left out");
  // The error about a file without any other water names it, too.
  ExpectError(AirWith({WaterOf("conv", convective, 1e-3)}),
              "no variable on x, y and z is a hydrometeor (conv is none, because its standard name "
              "mass_fraction_of_convective_cloud_liquid_water_in_air");
}

TEST_F(CfWater, OtherVariablesAreNotNamed) {
  SyntheticCf file =
      AirWith({WaterOf("qr", "", 1e-3, "kg m-3"), WaterOf("qv", "", 1e-3),
               WaterOf("tendency", "tendency_of_mass_fraction_of_rain_in_air", 1e-3, "s-1"),
               WaterOf("number", "number_concentration_of_ice_crystals_in_air", 1e-3, "m-3"),
               WaterOf("salt", "mass_fraction_of_sea_salt_dry_aerosol_particles_in_air", 1e-3),
               WaterOf("vapor", "mass_fraction_of_water_vapor_in_air", 1e-3),
               WaterOf("cloud_fraction", "", 1e-3, "1"), WaterOf("qke", "", 1e-3, "m2 s-2"),
               WaterOf("terrain_density", "", 1e-3, "kg m-3")});
  // A column total is no part of the storm.
  file.variables.push_back(
      OfOneValue("clwvi", {"y", "x"}, {{"units", "kg m-3"}, {"long_name", "cloud water"}}, 1.0));
  ExpectPaths(file, {{Hydrometeor::kRain, 2.0}});
  EXPECT_THAT(info_.assumptions, Each(Not(HasSubstr("left out"))));
}

TEST_F(CfWater, AllCloudIsPreferredToStratiformCloud) {
  const CfContent all =
      WaterOf("all", "mass_fraction_of_cloud_liquid_water_in_air", 2e-3, "kg m-3");
  const CfContent part =
      WaterOf("part", "mass_fraction_of_stratiform_cloud_liquid_water_in_air", 1e-3, "kg m-3");
  for (const auto& both : {std::vector<CfContent>{part, all}, {all, part}}) {
    ExpectPaths(AirWith(both), {{Hydrometeor::kCloud, 4.0}});
    ExpectSaid("part is left out, because all is shown as cloud.");
  }
}

TEST_F(CfWater, SaysOfWhichAirMixingRatiosAre) {
  const std::string dry = "The air is taken as dry, because the file has no humidity.";
  ExpectPaths(AirWith({WaterOf("qc", "", 1e-3), WaterOf("qr", "", 1e-3)}),
              {{Hydrometeor::kCloud, PathOf(1e-3)}, {Hydrometeor::kRain, PathOf(1e-3)}});
  ExpectSaid("qc, qr are taken to be per kg of dry air, because the file does not say which");
  ExpectSaid(dry);
  EXPECT_TRUE(Read(AirWith({WaterOf("qc", "cloud_liquid_water_mixing_ratio", 1e-3)})).ok());
  ExpectSaid("qc is per kg of dry air, by the standard name.");
  SyntheticCf file = AirWith({WaterOf("qc", "mass_fraction_of_cloud_liquid_water_in_air", 1e-3),
                              WaterOf("hus", "specific_humidity", 1e-2)});
  EXPECT_TRUE(Read(file).ok());
  ExpectSaid("qc is per kg of the whole air (dry air, vapour and condensate), by the standard");
  EXPECT_THAT(info_.assumptions, Each(Not(HasSubstr("taken as dry"))));
  CfContent content = WaterOf("ql", "", 1e-3);
  content.attributes["long_name"] = "specific liquid water";
  file = AirWith({content});
  file.variables[1] = OfOneValue("rho", {"z", "y", "x"}, {{"units", "kg m-3"}}, 1.0);
  ExpectPaths(file, {{Hydrometeor::kCloud, 2.0 / 0.999}});
  ExpectSaid("ql is per kg of the whole air (dry air, vapour and condensate), by the long name.");
  ExpectSaid("The density rho is taken as that of dry air, because the file has no humidity.");
  // Masses per volume need no air.
  EXPECT_TRUE(Read(AirWith({WaterOf("qc", "", 1e-3, "kg m-3")})).ok());
  EXPECT_THAT(info_.assumptions, Each(Not(HasSubstr("dry"))));
}

// A series whose second file lacks the rain is one storm.
TEST_F(CfWater, AFileOfASeriesMayLackAField) {
  const auto at = [](double hour, std::vector<CfContent> water) {
    SyntheticCf file = AirWith(std::move(water));
    file.coordinates.push_back({"time", {hour}, {{"units", "hours since 2020-01-01"}}, {}});
    file.variables[0].dimensions = {"time", "z", "y", "x"};
    return file;
  };
  const CfContent cloud = WaterOf("qc", "", 1e-3);
  const CfContent rain = WaterOf("qr", "", 1e-3);
  const auto write = [&](const std::string& folder, const std::string& name,
                         const SyntheticCf& file) {
    std::filesystem::create_directories(folder_.File(folder));
    testing::WriteCf(file, folder_.File(folder + "/" + name));
  };
  write("run", "a.nc", at(0.0, {cloud, rain}));
  write("run", "b.nc", at(1.0, {cloud}));
  write("run", "c.nc", at(2.0, {cloud, rain}));
  auto store = storm_store::StormStore::Open({folder_.File("run")}, {.read_ahead = 0});
  ASSERT_TRUE(store.ok()) << store.status();
  ASSERT_EQ((*store)->Storms().size(), 1U);
  const storm_store::StormInfo info = *(*store)->Storms().front();
  ASSERT_EQ(info.times.size(), 3U);
  EXPECT_THAT(info.assumptions, Contains(HasSubstr("b.nc: has no rain, which other files of the "
                                                   "run have")));
  for (const int time : {0, 1, 2}) {
    const auto fields = (*store)->Get(info.id, time, {});
    ASSERT_TRUE(fields.ok()) << fields.status();
    EXPECT_EQ((*fields)->fields.size(), time == 1 ? 1U : 2U);
  }
  // One series for each hydrometeor remains two storms, so that no water is lost.
  for (const double hour : {0.0, 1.0, 2.0}) {
    const std::string number = std::to_string(static_cast<int>(hour));
    write("each", "cloud" + number + ".nc", at(hour, {cloud}));
    write("each", "rain" + number + ".nc", at(hour, {rain}));
  }
  store = storm_store::StormStore::Open({folder_.File("each")}, {.read_ahead = 0});
  ASSERT_TRUE(store.ok()) << store.status();
  ASSERT_EQ((*store)->Storms().size(), 2U);
  for (const storm_store::StormInfoPtr& storm : (*store)->Storms()) {
    EXPECT_EQ(storm->times.size(), 3U);
    EXPECT_EQ(storm->fields.size(), 1U);
  }
}

}  // namespace
}  // namespace thunderhead::storm_files
