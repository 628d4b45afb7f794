// Tests of CF files in the layouts of models: the names, dimensions, units and attributes that each
// model or its own converter writes. Each file is read with the right amounts, or one error names
// the model and what to add.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "physics/hydrometeors.h"
#include "storm_files/mixed_water.h"
#include "storm_files/reference_atmosphere.h"
#include "tests/unit/storm_files/cf_file_test.h"

namespace thunderhead::storm_files {
namespace {

using physics::Hydrometeor;
using testing::CfContent;
using testing::CfCoordinate;
using ::testing::Contains;
using ::testing::HasSubstr;
using testing::Middles;
using testing::SyntheticCf;

constexpr std::size_t kModelColumns = 6;
constexpr std::size_t kModelRows = 4;
constexpr std::size_t kModelLayers = 4;
constexpr double kModelThickness_m = 500.0;
constexpr double kModelGas_J_per_kg_K = 287.0;

class CfModels : public CfFileTest {
 protected:
  // Expects the hydrometeors with these largest water paths.
  void ExpectPaths(const SyntheticCf& file, const std::map<Hydrometeor, double>& paths_kg_per_m2) {
    const auto fields = Read(file);
    ASSERT_TRUE(fields.ok()) << fields.status();
    ASSERT_EQ((*fields)->fields.size(), paths_kg_per_m2.size());
    for (const volume::HydrometeorField& field : (*fields)->fields) {
      ASSERT_TRUE(paths_kg_per_m2.contains(field.hydrometeor));
      const double expected = paths_kg_per_m2.at(field.hydrometeor);
      EXPECT_NEAR(field.statistics.maximum_water_path_kg_per_m2, expected, 2e-3 * expected)
          << physics::NameOf(field.hydrometeor);
    }
  }
};

CfCoordinate EvenAxis(const std::string& name, std::size_t count, double low, double spacing) {
  return {name, Middles(count, low, spacing), {{"units", "m"}}, {}};
}

// Returns a variable with a value in the lowest layer. `z` is its dimension.
CfContent InLowest(const std::string& name, const std::vector<std::string>& on, Texts attributes,
                   const std::string& z, double value) {
  return {name, on, std::move(attributes),
          [z, value](const Index& at) { return at.at(z) == 0 ? value : 0.0; }};
}

// Removes a variable.
void DropVariable(SyntheticCf& file, const std::string& name) {
  const auto removed =
      std::erase_if(file.variables, [&](const CfContent& content) { return content.name == name; });
  ASSERT_EQ(removed, 1U);
}

Texts WithName(const std::string& long_name, const std::string& units) {
  return {{"long_name", long_name}, {"units", units}};
}

// The names and units of UCLA-LES's ncio.f90. Its time counts from an arbitrary date.
TEST_F(CfModels, UclaLesHasPotentialTemperatureAsT) {
  SyntheticCf file;
  file.coordinates = {EvenAxis("xt", kModelColumns, 0.0, 100.0),
                      EvenAxis("yt", kModelRows, 0.0, 100.0),
                      EvenAxis("zt", kModelLayers, 0.0, kModelThickness_m),
                      {"time", {3600.0}, {{"units", "seconds since 2000-01-01 0000"}}, {}}};
  const std::vector<std::string> on = {"time", "yt", "xt", "zt"};
  file.variables = {OfOneValue("dn0", {"zt"}, WithName("Base-state density", "kg/m^3"), 1.1),
                    OfOneValue("t", on, WithName("Liquid Water Potential temperature", "K"), 300.0),
                    OfOneValue("p", on, WithName("Pressure", "Pa"), 95'000.0),
                    OfOneValue("q", on, WithName("Total water mixing ratio", "g/kg"), 10.0),
                    InLowest("l", on, WithName("Liquid water mixing ratio", "g/kg"), "zt", 0.5),
                    InLowest("r", on, WithName("Rain-water mixing ratio", "g/kg"), "zt", 0.25),
                    InLowest("rgrp", on, WithName("Graupel mixing ratio", "g/kg"), "zt", 0.125)};
  ExpectPaths(file, {{Hydrometeor::kCloud, 0.5e-3 * 1.1 * kModelThickness_m},
                     {Hydrometeor::kRain, 0.25e-3 * 1.1 * kModelThickness_m},
                     {Hydrometeor::kGraupel, 0.125e-3 * 1.1 * kModelThickness_m}});
  DropVariable(file, "dn0");
  ExpectError(file, "UCLA-LES writes the liquid water potential temperature as t");
}

// The names and units of DALES' modfielddump.f90 and modgenstat.f90.
TEST_F(CfModels, DalesNeedsTheDensityOfItsProfiles) {
  SyntheticCf file;
  file.coordinates = {EvenAxis("xt", kModelColumns, 0.0, 100.0),
                      EvenAxis("yt", kModelRows, 0.0, 100.0),
                      EvenAxis("zt", kModelLayers, 0.0, kModelThickness_m),
                      {"time", {3600.0}, {{"units", "s"}}, {}}};
  const std::vector<std::string> on = {"time", "zt", "yt", "xt"};
  file.variables = {
      OfOneValue("qt", on, WithName("Total water specific humidity", "kg/kg"), 0.01),
      OfOneValue("thl", on, WithName("Liquid water potential temperature", "K"), 300.0),
      InLowest("ql", on, WithName("Liquid water specific humidity", "kg/kg"), "zt", 5e-4),
      InLowest("plw", on, WithName("mass fraction of precipitating liquid water", "kg/kg"), "zt",
               2e-4)};
  ExpectError(file, "DALES field dumps do not have the air's density; merge the base state rhobf");
  file.variables.push_back(
      OfOneValue("rhobf", {"zt"}, WithName("Full level base-state density", "kg/m^3"), 1.1));
  ExpectPaths(file, {{Hydrometeor::kCloud, 5e-4 * 1.1 * kModelThickness_m},
                     {Hydrometeor::kRain, 2e-4 * 1.1 * kModelThickness_m}});
}

// MicroHH's 3d_to_nc.py writes one variable to a file, without units.
TEST_F(CfModels, MicroHhNeedsUnitsAndTheBaseState) {
  SyntheticCf file;
  file.coordinates = {EvenAxis("x", kModelColumns, 0.0, 100.0),
                      EvenAxis("y", kModelRows, 0.0, 100.0),
                      EvenAxis("z", kModelLayers, 0.0, kModelThickness_m),
                      {"time", {3600.0}, {{"units", "seconds since start"}}, {}}};
  const std::vector<std::string> on = {"time", "z", "y", "x"};
  file.variables = {InLowest("ql", on, {}, "z", 5e-4)};
  ExpectError(file, "ql has no units; MicroHH's 3d_to_nc.py writes no units");
  file.variables = {InLowest("ql", on, {{"units", "kg kg-1"}}, "z", 5e-4),
                    OfOneValue("rhoref", {"z"}, {{"units", "kg m-3"}}, 1.1)};
  ExpectPaths(file, {{Hydrometeor::kCloud, 5e-4 * 1.1 * kModelThickness_m}});
}

// PALM's pressure is about zero, and its names do not say that it is a deviation.
TEST_F(CfModels, PalmsPressureIsNotTheWholePressure) {
  SyntheticCf file;
  file.coordinates = {EvenAxis("x", kModelColumns, 0.0, 100.0),
                      EvenAxis("y", kModelRows, 0.0, 100.0),
                      EvenAxis("zu_3d", kModelLayers, 0.0, kModelThickness_m),
                      {"time", {3600.0}, {{"units", "seconds since 2018-06-21 00:00:00 +00"}}, {}}};
  const std::vector<std::string> on = {"time", "zu_3d", "y", "x"};
  file.variables = {InLowest("ql", on, WithName("ql", "kg/kg"), "zu_3d", 5e-4),
                    InLowest("qr", on, WithName("qr", "kg/kg"), "zu_3d", 1e-4),
                    OfOneValue("p", on, WithName("p", "Pa"), 1.5),
                    OfOneValue("theta", on, WithName("theta", "K"), 300.0),
                    OfOneValue("E_UTM", {"y", "x"}, WithName("easting", "m"), 5e5),
                    OfOneValue("N_UTM", {"y", "x"}, WithName("northing", "m"), 5e6)};
  ExpectError(file, "(p is only the deviation from a reference state); PALM's p");
  file.variables.push_back(OfOneValue("rho", {"zu_3d"}, WithName("rho", "kg/m3"), 1.1));
  ExpectPaths(file, {{Hydrometeor::kCloud, 5e-4 * 1.1 * kModelThickness_m},
                     {Hydrometeor::kRain, 1e-4 * 1.1 * kModelThickness_m}});
}

TEST_F(CfModels, MoncHasDeviationsFromItsBaseState) {
  SyntheticCf file;
  file.coordinates = {EvenAxis("x", kModelColumns, 0.0, 100.0),
                      EvenAxis("y", kModelRows, 0.0, 100.0),
                      EvenAxis("zn", kModelLayers, 0.0, kModelThickness_m),
                      {"time_series_300_1800", {3600.0}, {{"units", "s"}}, {}}};
  const std::vector<std::string> on = {"time_series_300_1800", "x", "y", "zn"};
  file.variables = {InLowest("q_cloud_liquid_mass", on, {{"units", "kg/kg"}}, "zn", 5e-4),
                    InLowest("q_ice_mass", on, {{"units", "kg/kg"}}, "zn", 1e-4),
                    OfOneValue("q_vapour", on, {{"units", "kg/kg"}}, 0.0),
                    OfOneValue("th", on, {{"units", "K"}}, 0.5),
                    OfOneValue("p", on, {{"units", "Pa"}}, 2.0)};
  ExpectError(file, "(th and p are only deviations from a reference state); MONC's p and th");
  file.variables.push_back(
      OfOneValue("rhon", {"time_series_300_1800", "zn"}, {{"units", "kg/m3"}}, 1.1));
  ExpectPaths(file, {{Hydrometeor::kCloud, 5e-4 * 1.1 * kModelThickness_m},
                     {Hydrometeor::kIce, 1e-4 * 1.1 * kModelThickness_m}});
}

// Returns SAM's layout. Its texts are filled up with blanks.
SyntheticCf SamOutput(double temperature_K) {
  SyntheticCf file;
  file.coordinates = {EvenAxis("x", kModelColumns, 0.0, 100.0),
                      EvenAxis("y", kModelRows, 0.0, 100.0),
                      EvenAxis("z", kModelLayers, 0.0, kModelThickness_m),
                      {"time", {0.5}, {{"units", "d"}}, {}}};
  const std::vector<std::string> on = {"time", "z", "y", "x"};
  file.variables = {
      OfOneValue("p", {"z"}, WithName("Pressure", "mb"), 600.0),
      OfOneValue("PP", on, WithName("Pressure Perturbation     ", "Pa        "), 3.0),
      OfOneValue("TABS", on, WithName("Absolute Temperature      ", "K         "), temperature_K),
      OfOneValue("QV", on, WithName("Water Vapor               ", "g/kg      "), 0.0),
      InLowest("QN", on, WithName("Non-precipitating Condensate (Water+Ice)   ", "g/kg      "), "z",
               0.8),
      InLowest("QP", on, WithName("Precipitating Water (Rain+Snow)            ", "g/kg      "), "z",
               0.4)};
  return file;
}

TEST_F(CfModels, SamsCondensateIsDividedByTemperature) {
  // Cloud is mixed over a range of 20 K, and 270.66 K is 17.5 K above the range's lower limit. Rain
  // is mixed over a range of 15 K, and this temperature is 2.5 K above its lower limit.
  const double per_g = 1e-3 * 60'000.0 / (kModelGas_J_per_kg_K * 270.66) * kModelThickness_m;
  const double graupel_in_ice = (270.66 - 223.16) / 60.0;
  ExpectPaths(SamOutput(270.66),
              {{Hydrometeor::kCloud, 0.8 * 0.875 * per_g},
               {Hydrometeor::kIce, 0.8 * 0.125 * per_g},
               {Hydrometeor::kRain, 0.4 / 6.0 * per_g},
               {Hydrometeor::kSnow, 0.4 * 5.0 / 6.0 * (1.0 - graupel_in_ice) * per_g},
               {Hydrometeor::kGraupel, 0.4 * 5.0 / 6.0 * graupel_in_ice * per_g}});
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("QN is divided into cloud water and ice")));
  // If the file has separate variables for the phases, QN adds nothing and is left out.
  SyntheticCf file = SamOutput(270.66);
  const std::vector<std::string> on = {"time", "z", "y", "x"};
  file.variables.push_back(InLowest("QC", on, WithName("Cloud Water", "g/kg"), "z", 0.5));
  file.variables.push_back(InLowest("QR", on, WithName("Rain Water", "g/kg"), "z", 0.25));
  ExpectPaths(file, {{Hydrometeor::kCloud, 0.5 * per_g}, {Hydrometeor::kRain, 0.25 * per_g}});
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("QN is left out")));
  file = SamOutput(270.66);
  DropVariable(file, "TABS");
  file.variables.push_back(OfOneValue("rho", {"z"}, WithName("Density", "kg/m3"), 1.0));
  ExpectError(file, "QN holds cloud water and ice, which only the temperature tells apart");
}

TEST(MixedWaterTest, SharesAddUpToOne) {
  for (const MixedWater mixed : {MixedWater::kCloud, MixedWater::kPrecipitation}) {
    for (float temperature_K = 200.0F; temperature_K < 310.0F; temperature_K += 0.7F) {
      float sum = 0.0F;
      for (const Hydrometeor each : HydrometeorsIn(mixed)) {
        sum += ShareOf(mixed, each, temperature_K);
      }
      EXPECT_NEAR(sum, 1.0F, 1e-5F) << temperature_K;
    }
  }
  EXPECT_EQ(ShareOf(MixedWater::kCloud, Hydrometeor::kIce, 250.0F), 1.0F);
  EXPECT_EQ(ShareOf(MixedWater::kPrecipitation, Hydrometeor::kSnow, 220.0F), 1.0F);
  EXPECT_EQ(ShareOf(MixedWater::kPrecipitation, Hydrometeor::kRain, 290.0F), 1.0F);
  EXPECT_TRUE(std::isnan(ShareOf(MixedWater::kCloud, Hydrometeor::kIce, NAN)));
}

// Each share is 0 and 1 at the limits of SAM's micro_params.f90, and a half between them.
TEST(MixedWaterTest, SharesHaveTheLimitsOfSam) {
  const auto cloud = [](float temperature_K) {
    return ShareOf(MixedWater::kCloud, Hydrometeor::kCloud, temperature_K);
  };
  const auto precipitation = [](Hydrometeor hydrometeor, float temperature_K) {
    return ShareOf(MixedWater::kPrecipitation, hydrometeor, temperature_K);
  };
  constexpr float kStep_K = 0.1F;
  constexpr float kRounding = 1e-5F;
  EXPECT_EQ(cloud(253.16F), 0.0F);
  EXPECT_NEAR(cloud(253.16F + kStep_K), kStep_K / 20.0F, kRounding);
  EXPECT_NEAR(cloud(263.16F), 0.5F, kRounding);
  EXPECT_NEAR(cloud(273.16F - kStep_K), 1.0F - kStep_K / 20.0F, kRounding);
  EXPECT_EQ(cloud(273.16F), 1.0F);
  EXPECT_EQ(precipitation(Hydrometeor::kRain, 268.16F), 0.0F);
  EXPECT_NEAR(precipitation(Hydrometeor::kRain, 268.16F + kStep_K), kStep_K / 15.0F, kRounding);
  EXPECT_NEAR(precipitation(Hydrometeor::kRain, 275.66F), 0.5F, kRounding);
  EXPECT_EQ(precipitation(Hydrometeor::kRain, 283.16F), 1.0F);
  EXPECT_EQ(precipitation(Hydrometeor::kGraupel, 223.16F), 0.0F);
  EXPECT_NEAR(precipitation(Hydrometeor::kGraupel, 223.16F + kStep_K), kStep_K / 60.0F, kRounding);
  EXPECT_NEAR(precipitation(Hydrometeor::kGraupel, 253.16F), 0.5F, kRounding);
  // At 268.16 K there is no rain yet, and graupel is 45 of 60 K above its limit.
  EXPECT_NEAR(precipitation(Hydrometeor::kGraupel, 268.16F), 0.75F, kRounding);
  EXPECT_NEAR(precipitation(Hydrometeor::kSnow, 268.16F), 0.25F, kRounding);
}

// Meso-NH's levels follow the terrain, although their coordinate is in metres. Its lowest level is
// below the ground.
TEST_F(CfModels, MesoNhLevelsFollowTheTerrain) {
  SyntheticCf file;
  file.coordinates = {EvenAxis("ni", kModelColumns, 0.0, 1000.0),
                      EvenAxis("nj", kModelRows, 0.0, 1000.0),
                      {"level",
                       {-250.0, 250.0, 750.0, 1250.0},
                       {{"units", "m"},
                        {"axis", "Z"},
                        {"positive", "up"},
                        {"long_name", "position z in the transformed space"},
                        {"standard_name", ""},
                        {"computed_standard_name", "altitude"},
                        {"formula_terms", "s: level height: ZTOP orog: ZS"}},
                       {}},
                      {"time", {0.0}, {{"units", "seconds since 2020-07-01 00:00:00 +0:00"}}, {}}};
  const std::vector<std::string> on = {"time", "level", "nj", "ni"};
  file.variables = {{"RCT", on, WithName("RCT", "kg kg-1"),
                     [](const Index& at) { return at.at("level") == 1 ? 5e-4 : 0.0; }},
                    OfOneValue("RHT", on, WithName("RHT", "kg kg-1"), 0.0),
                    OfOneValue("RVT", on, WithName("RVT", "kg kg-1"), 0.0),
                    OfOneValue("THT", on, WithName("THT", "K"), 300.0),
                    OfOneValue("PABST", on, WithName("PABST", "Pa"), 100'000.0),
                    {"ZS",
                     {"nj", "ni"},
                     WithName("ZS", "m"),
                     [](const Index& at) { return at.at("ni") < 3 ? 1000.0 : 0.0; }},
                    OfOneValue("ZTOP", {}, WithName("ZTOP", "m"), 10'000.0)};
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_FLOAT_EQ((*fields)->terrain_height_m[0], 1000.0F);
  // A layer of 500 m is thinner above high ground, by the factor 1 - ZS / ZTOP.
  const double path = 5e-4 * 100'000.0 / (kModelGas_J_per_kg_K * 300.0) * kModelThickness_m;
  const volume::FieldStatistics& statistics = (*fields)->fields[0].statistics;
  EXPECT_NEAR(statistics.maximum_water_path_kg_per_m2, path, 2e-3 * path);
  EXPECT_NEAR(statistics.mean_water_path_kg_per_m2, 0.95 * path, 2e-3 * path);
  DropVariable(file, "ZTOP");
  ExpectError(file, "needs the formula term height (ZTOP)");
}

// Appendix D of the CF conventions: z = a ztop + b1 zsurf1 + b2 zsurf2.
TEST_F(CfModels, SleveHeightsFollowFromTheirFormula) {
  SyntheticCf file;
  file.coordinates = {
      EvenAxis("x", kModelColumns, 0.0, 1000.0),
      EvenAxis("y", kModelRows, 0.0, 1000.0),
      {"lev",
       {0.1, 0.2},
       {{"standard_name", "atmosphere_sleve_coordinate"},
        {"units", "1"},
        {"formula_terms", "a: a b1: b1 b2: b2 ztop: ztop zsurf1: large zsurf2: small"}},
       {}}};
  const auto along = [](const std::string& name, double low, double high) {
    return CfContent{name, {"lev"}, {{"units", "1"}}, [=](const Index& at) {
                       return at.at("lev") == 0 ? low : high;
                     }};
  };
  const auto ground = [](const std::string& name, double height_m) {
    return CfContent{name, {"y", "x"}, {{"units", "m"}}, [=](const Index& at) {
                       return at.at("x") == 0 ? height_m : 0.0;
                     }};
  };
  file.variables = {OfOneValue("qc", {"lev", "y", "x"}, {{"units", "kg m-3"}}, 1e-4),
                    along("a", 0.1, 0.3),
                    along("b1", 0.8, 0.4),
                    along("b2", 0.5, 0.1),
                    ground("large", 600.0),
                    ground("small", 100.0),
                    OfOneValue("ztop", {}, {{"units", "km"}}, 10.0)};
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  // Faces over low ground: 0, 2000 and 4000 m. Over high ground the lowest is at 700 m.
  EXPECT_NEAR((*fields)->fields[0].statistics.maximum_water_path_kg_per_m2, 0.4, 1e-4);
  EXPECT_NEAR((*fields)->fields[0].statistics.mean_water_path_kg_per_m2,
              1e-4 * (4000.0 - 700.0 / kModelColumns), 1e-4);
  DropVariable(file, "small");
  ExpectError(file, "needs the formula term zsurf2 (small)");
}

TEST(ReferenceAtmosphereTest, IsAtRest) {
  ReferenceAtmosphere lapse;
  ReferenceAtmosphere exponential;
  exponential.exponential = true;
  exponential.sea_level_K = 300.0;
  for (const ReferenceAtmosphere& each : {lapse, exponential}) {
    EXPECT_DOUBLE_EQ(each.Pressure_Pa(0.0), 1e5);
    for (double height_m = 500.0; height_m < 12'000.0; height_m += 500.0) {
      // Compares the temperature of the formulas with the temperature that follows from the
      // pressure by the hydrostatic equation.
      const double fall =
          std::log(each.Pressure_Pa(height_m - 1.0) / each.Pressure_Pa(height_m + 1.0));
      const double at_rest_K = 9.80665 / 287.05 * 2.0 / fall;
      const double expected_K = each.exponential
                                    ? 225.0 + 75.0 * std::exp(-height_m / 10'000.0)
                                    : 288.15 * std::sqrt(1.0 - 2.0 * 42.0 * 9.80665 * height_m /
                                                                   (287.05 * 288.15 * 288.15));
      EXPECT_NEAR(at_rest_K, expected_K, 0.01) << height_m;
    }
  }
}

// COSMO writes the deviation of pressure, and the reference atmosphere as attributes of vcoord.
TEST_F(CfModels, CosmoAddsItsReferenceAtmosphere) {
  SyntheticCf file;
  file.coordinates = {EvenAxis("x", kModelColumns, 0.0, 1000.0),
                      EvenAxis("y", kModelRows, 0.0, 1000.0),
                      {"level", {1, 2, 3, 4}, {{"axis", "Z"}, {"positive", "down"}}, {}},
                      {"level1", {1, 2, 3, 4, 5}, {{"axis", "Z"}, {"positive", "down"}}, {}}};
  const std::vector<std::string> on = {"level", "y", "x"};
  const Texts deviation = {{"standard_name", "difference_of_air_pressure_from_model_reference"},
                           {"units", "Pa"}};
  file.variables = {
      {"QC",
       on,
       {{"standard_name", "mass_fraction_of_cloud_liquid_water_in_air"}, {"units", "kg kg-1"}},
       [](const Index& at) { return at.at("level") == 0 ? 5e-4 : 0.0; }},
      OfOneValue("PP", on, deviation, 200.0),
      OfOneValue("T", on, {{"standard_name", "air_temperature"}, {"units", "K"}}, 270.0),
      {"HHL",
       {"level1", "y", "x"},
       {{"standard_name", "altitude"}, {"units", "m"}},
       [](const Index& at) { return 1000.0 * static_cast<double>(4 - at.at("level1")); }}};
  ExpectError(file, "PP is only the deviation from a reference state");
  file.variables.push_back(OfOneValue("vcoord", {"level1"}, {{"units", "Pa"}}, 0.0));
  file.number_attributes["vcoord"] = {{"irefatm", 2},  {"p0sl", 1e5},     {"t0sl", 288.15},
                                      {"dt0lp", 42.0}, {"delta_t", 75.0}, {"h_scal", 10'000.0}};
  // This is the pressure at the middle of the highest layer, 3500 m, by the formula and COSMO's
  // constants.
  const double top_K = 288.15 - 75.0;
  const double pressure_Pa =
      200.0 + 1e5 * std::exp(-9.80665 / 287.05 * 10'000.0 / top_K *
                             std::log((std::exp(0.35) * top_K + 75.0) / 288.15));
  EXPECT_GT(pressure_Pa, 60'000.0);
  EXPECT_LT(pressure_Pa, 70'000.0);
  ExpectPaths(
      file, {{Hydrometeor::kCloud, 5e-4 * pressure_Pa / (kModelGas_J_per_kg_K * 270.0) * 1000.0}});
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("COSMO's reference atmosphere")));
  // If the file has the whole pressure, it is used instead.
  file.variables.push_back(
      OfOneValue("P", on, {{"standard_name", "air_pressure"}, {"units", "Pa"}}, 80'000.0));
  ExpectPaths(file,
              {{Hydrometeor::kCloud, 5e-4 * 80'000.0 / (kModelGas_J_per_kg_K * 270.0) * 1000.0}});
}

}  // namespace
}  // namespace thunderhead::storm_files
