// Tests of heights that follow from a formula: the bounds of formula terms, the names of CAM and
// ECHAM, and CM1's heights over terrain.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "physics/hydrometeors.h"
#include "tests/unit/storm_files/cf_file_test.h"

namespace thunderhead::storm_files {
namespace {

using testing::CfContent;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::SyntheticCf;

constexpr double kGas_J_per_kg_K = 287.0;
constexpr double kGravity_m_per_s2 = 9.80665;
constexpr double kAir_K = 280.0;

class CfFormula : public CfFileTest {
 protected:
  // Expects the largest water path of the only field.
  void ExpectPath(const SyntheticCf& file, double path_kg_per_m2) {
    const auto fields = Read(file);
    ASSERT_TRUE(fields.ok()) << fields.status();
    ASSERT_EQ((*fields)->fields.size(), 1U);
    EXPECT_NEAR((*fields)->fields[0].statistics.maximum_water_path_kg_per_m2, path_kg_per_m2,
                2e-3 * path_kg_per_m2);
  }
};

// Returns a variable with these values along a dimension.
template <std::size_t count>
CfContent Along(const std::string& name, const std::string& dimension, Texts attributes,
                const std::array<double, count>& values) {
  return {name, {dimension}, std::move(attributes), [dimension, values](const Index& at) {
            return values.at(at.at(dimension));
          }};
}

// Returns the bounds of layers between these faces.
template <std::size_t count>
CfContent BoundsBetween(const std::string& name, Texts attributes,
                        const std::array<double, count>& faces, bool swapped = false) {
  return {name, {"lev", "bnds"}, std::move(attributes), [faces, swapped](const Index& at) {
            const std::size_t second = swapped ? 1 - at.at("bnds") : at.at("bnds");
            return faces.at(at.at("lev") + second);
          }};
}

CfContent& Variable(SyntheticCf& file, const std::string& name) {
  return *std::ranges::find(file.variables, name, &CfContent::name);
}

void Remove(SyntheticCf& file, const std::string& name) {
  ASSERT_EQ(
      std::erase_if(file.variables, [&](const CfContent& content) { return content.name == name; }),
      1U);
}

// The terms of four layers from the top. The layers are thicker than their middles suggest, so
// interfaces half-way between the middles are wrong.
constexpr std::array kA = {250.0, 0.0, 0.0, 0.0};
constexpr std::array kB = {0.2, 0.45, 0.7, 0.95};
constexpr std::array kFaceA = {500.0, 0.0, 0.0, 0.0, 0.0};
constexpr std::array kFaceB = {0.0, 0.3, 0.5, 0.8, 1.0};

// Returns cloud water of 1e-4 kg kg-1 in the layer `cloudy`, counted from the top, of a file in the
// layout of CMIP.
SyntheticCf Cmip(std::size_t cloudy) {
  SyntheticCf file = testing::ExtinctionFile(6, 4, 4, 1000.0, 1000.0, 500.0, {});
  const std::vector<std::string> on = {"lev", "y", "x"};
  file.coordinates[2] = {"lev",
                         {0.2, 0.45, 0.7, 0.95},
                         {{"units", "1"},
                          {"positive", "down"},
                          {"standard_name", "atmosphere_hybrid_sigma_pressure_coordinate"},
                          {"formula_terms", "ap: ap b: b ps: ps"}},
                         {kFaceB.begin(), kFaceB.end()}};
  file.bounds_attributes = {{"formula_terms", "ap: ap_bnds b: b_bnds ps: ps"}};
  file.coordinates.push_back({"bnds", {0.0, 1.0}, {}, {}, false});
  file.variables = {{"clw",
                     on,
                     {{"units", "kg kg-1"}},
                     [cloudy](const Index& at) { return at.at("lev") == cloudy ? 1e-4 : 0.0; }},
                    OfOneValue("ta", on, {{"units", "K"}}, kAir_K),
                    OfOneValue("ps", {"y", "x"}, {{"units", "Pa"}}, 1e5),
                    Along("ap", "lev", {{"units", "Pa"}}, kA),
                    Along("b", "lev", {}, kB),
                    BoundsBetween("ap_bnds", {}, kFaceA),
                    BoundsBetween("b_bnds", {}, kFaceB)};
  return file;
}

// Returns the water path of a layer, which is its density times its thickness in air of 280 K at
// rest.
double PathBetween(double low_Pa, double high_Pa, double middle_Pa) {
  const double thick_m = kGas_J_per_kg_K * kAir_K / kGravity_m_per_s2 * std::log(low_Pa / high_Pa);
  return 1e-4 * middle_Pa / (kGas_J_per_kg_K * kAir_K) * thick_m;
}

TEST_F(CfFormula, InterfacesAreTheBoundsOfTheTerms) {
  ExpectPath(Cmip(3), PathBetween(1e5, 0.8e5, 0.95e5));
  ExpectPath(Cmip(2), PathBetween(0.8e5, 0.5e5, 0.7e5));
  ExpectPath(Cmip(1), PathBetween(0.5e5, 0.3e5, 0.45e5));
  EXPECT_THAT(info_.assumptions, Not(Contains(HasSubstr("half-way"))));
  // The two bounds of a layer may be written in either order.
  SyntheticCf file = Cmip(2);
  Variable(file, "ap_bnds") = BoundsBetween("ap_bnds", {}, kFaceA, true);
  Variable(file, "b_bnds") = BoundsBetween("b_bnds", {}, kFaceB, true);
  ExpectPath(file, PathBetween(0.8e5, 0.5e5, 0.7e5));
  // Without bounds the interfaces are half-way between the middles, and this is said.
  Remove(file, "ap_bnds");
  Remove(file, "b_bnds");
  ExpectPath(file, PathBetween(0.825e5, 0.575e5, 0.7e5));
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("half-way between their middles")));
}

TEST_F(CfFormula, BoundsOfTermsAreChecked) {
  SyntheticCf file = Cmip(2);
  Variable(file, "b_bnds").value = [](const Index& at) {
    return kFaceB.at(at.at("lev") + at.at("bnds")) + 0.05 * static_cast<double>(at.at("lev"));
  };
  ExpectError(file, "b_bnds, the bounds of b, leave a gap before cell 1");
  // Bounds say that a subset of levels does not begin at the ground.
  file = Cmip(2);
  Variable(file, "b_bnds") = BoundsBetween("b_bnds", {}, std::array{0.0, 0.3, 0.5, 0.8, 0.9});
  ExpectError(file, "begins far above the ground");
}

TEST_F(CfFormula, ASingleLayerNeedsBoundsOfItsTerms) {
  SyntheticCf file = Cmip(0);
  file.coordinates[2].values = {0.95};
  file.coordinates[2].faces = {0.8, 1.0};
  Variable(file, "ap") = Along("ap", "lev", {{"units", "Pa"}}, std::array{0.0});
  Variable(file, "b") = Along("b", "lev", {}, std::array{0.95});
  Variable(file, "ap_bnds") = BoundsBetween("ap_bnds", {}, std::array{0.0, 0.0});
  Variable(file, "b_bnds") = BoundsBetween("b_bnds", {}, std::array{0.8, 1.0});
  ExpectPath(file, PathBetween(1e5, 0.8e5, 0.95e5));
  Remove(file, "ap_bnds");
  Remove(file, "b_bnds");
  ExpectError(file, "has one layer, and its terms have no bounds");
}

// Returns a file with the names of CAM's history files, in which Q is per mass of moist air.
SyntheticCf Cam(bool with_terms) {
  SyntheticCf file = Cmip(2);
  constexpr double kReference_Pa = 1e5;
  file.bounds_attributes.clear();
  file.coordinates[2].faces.clear();
  file.coordinates[2].attributes = {{"units", "hPa"},
                                    {"positive", "down"},
                                    {"long_name", "hybrid level at midpoints (1000*(A+B))"}};
  if (with_terms) {
    file.coordinates[2].attributes["standard_name"] = "atmosphere_hybrid_sigma_pressure_coordinate";
    file.coordinates[2].attributes["formula_terms"] = "a: hyam b: hybm p0: P0 ps: PS";
  }
  file.coordinates[2].values = {202.5, 450.0, 700.0, 950.0};
  file.coordinates.push_back({"ilev", {5.0, 300.0, 500.0, 800.0, 1000.0}, {}, {}});
  const std::vector<std::string> on = {"lev", "y", "x"};
  file.variables = {
      {"CLDLIQ",
       on,
       {{"units", "kg/kg"}, {"long_name", "Grid box averaged cloud liquid amount"}},
       [](const Index& at) { return at.at("lev") == 2 ? 1e-4 : 0.0; }},
      OfOneValue("T", on, {{"units", "K"}}, kAir_K),
      OfOneValue("Q", on, {{"units", "kg/kg"}, {"long_name", "Specific humidity"}}, 0.01),
      OfOneValue("PS", {"y", "x"}, {{"units", "Pa"}}, 1e5),
      OfOneValue("P0", {}, {{"units", "Pa"}}, kReference_Pa),
      Along("hyam", "lev", {}, std::array{250.0 / kReference_Pa, 0.0, 0.0, 0.0}),
      Along("hybm", "lev", {}, kB),
      Along("hyai", "ilev", {}, std::array{500.0 / kReference_Pa, 0.0, 0.0, 0.0, 0.0}),
      Along("hybi", "ilev", {}, kFaceB)};
  return file;
}

TEST_F(CfFormula, CamsNamesAreRead) {
  for (const bool with_terms : {true, false}) {
    SyntheticCf file = Cam(with_terms);
    // The mass of moist air in a layer depends on pressure alone.
    ExpectPath(file, 1e-4 * 0.7e5 * std::log(0.8 / 0.5) / kGravity_m_per_s2);
    EXPECT_THAT(info_.assumptions, Contains(HasSubstr("CLDLIQ is per kg of moist air")));
    Remove(file, "P0");
    ExpectError(file, "needs the formula term p0 (P0)");
    file = Cam(with_terms);
    Remove(file, "PS");
    ExpectError(file, "needs the formula term ps");
  }
}

TEST_F(CfFormula, AllOfCamsHydrometeorsAreRead) {
  using physics::Hydrometeor;
  for (const auto& [name, hydrometeor] :
       {std::pair{"CLDLIQ", Hydrometeor::kCloud}, std::pair{"CLDICE", Hydrometeor::kIce},
        std::pair{"RAINQM", Hydrometeor::kRain}, std::pair{"SNOWQM", Hydrometeor::kSnow},
        std::pair{"GRAUQM", Hydrometeor::kGraupel}}) {
    SyntheticCf file = Cam(false);
    file.variables[0].name = name;
    file.variables[0].attributes["long_name"] = "Grid box averaged amount";
    const auto fields = Read(file);
    ASSERT_TRUE(fields.ok()) << name << ": " << fields.status();
    EXPECT_EQ((*fields)->fields[0].hydrometeor, hydrometeor) << name;
  }
  // CAM names the kind of its mixing ratios in an attribute.
  SyntheticCf file = Cam(false);
  const auto moist = Read(file);
  ASSERT_TRUE(moist.ok()) << moist.status();
  file.variables[0].attributes["mixing_ratio"] = "dry";
  const auto dry = Read(file);
  ASSERT_TRUE(dry.ok()) << dry.status();
  EXPECT_NEAR((*dry)->fields[0].statistics.maximum_water_path_kg_per_m2 /
                  (*moist)->fields[0].statistics.maximum_water_path_kg_per_m2,
              0.99, 1e-3);
}

// CDO writes hyam and hyai on dimensions of their own, and numbers the levels.
TEST_F(CfFormula, TermsOnAnotherDimensionFollowTheNumbersOfLevels) {
  SyntheticCf file = Cam(false);
  file.coordinates[2].values = {1.0, 2.0, 3.0, 4.0};
  file.coordinates[2].attributes = {{"units", "level"}, {"long_name", "hybrid level at midpoints"}};
  file.coordinates.push_back({"nhym", {0.0, 1.0, 2.0, 3.0}, {}, {}, false});
  Variable(file, "hyam") = Along("hyam", "nhym", {{"units", "Pa"}}, kA);
  Variable(file, "hybm") = Along("hybm", "nhym", {{"units", "1"}}, kB);
  Variable(file, "hyai") = Along("hyai", "ilev", {{"units", "Pa"}}, kFaceA);
  const double path = 1e-4 * std::log(0.8 / 0.5) * 0.7e5 / kGravity_m_per_s2;
  ExpectPath(file, path);
  // Levels that were turned upside down keep their numbers.
  file.coordinates[2].values = {4.0, 3.0, 2.0, 1.0};
  file.variables[0].value = [](const Index& at) { return at.at("lev") == 1 ? 1e-4 : 0.0; };
  ExpectPath(file, path);
  file.coordinates[2].values = {10.0, 20.0, 30.0, 40.0};
  ExpectError(file, "lies on another dimension than lev");
}

// Returns a file with CM1's coordinates. The ground is at 400 m, and the nominal top at 2000 m.
SyntheticCf Cm1() {
  SyntheticCf file;
  file.coordinates = {{"xh", {-2.5, -1.5, -0.5, 0.5, 1.5, 2.5}, {{"units", "km"}}, {}},
                      {"yh", {-1.5, -0.5, 0.5, 1.5}, {{"units", "km"}}, {}},
                      {"zh", {0.25, 0.75, 1.25, 1.75}, {{"units", "km"}}, {}},
                      {"zf", {0.0, 0.5, 1.0, 1.5, 2.0}, {{"units", "km"}}, {}},
                      {"time", {3600.0}, {{"units", "s"}}, {}}};
  file.attributes = {{"CM1 version", "cm1r20.3"}};
  file.variables = {{"qc",
                     {"time", "zh", "yh", "xh"},
                     {{"units", "kg/m^3"}},
                     [](const Index& at) { return at.at("zh") == 1 ? 1e-4 : 0.0; }},
                    OfOneValue("zs", {"time", "yh", "xh"}, {{"units", "m"}}, 400.0)};
  return file;
}

// Layers between s = 500 and 1000 m reach from 400 + 500 * 0.8 to 400 + 1000 * 0.8.
TEST_F(CfFormula, Cm1HeightsFollowTheTerrain) {
  SyntheticCf file = Cm1();
  const auto expect_layer = [&](double low_m, double high_m) {
    const auto fields = Read(file);
    ASSERT_TRUE(fields.ok()) << fields.status();
    const double thick_m = high_m - low_m;
    EXPECT_NEAR((*fields)->fields[0].statistics.maximum_water_path_kg_per_m2, 1e-4 * thick_m,
                1e-4 * 1e-3 * thick_m);
    const volume::RegularGrid& grid = (*fields)->grid;
    double moment = 0.0;
    double mass = 0.0;
    for (int z = 0; z < grid.cells.z; ++z) {
      const double each = (*fields)->fields[0].concentration_kg_per_m3[grid.Offset(2, 2, z)];
      mass += each;
      moment += each * (grid.low_corner_m.z + (z + 0.5) * grid.spacing_m.z);
    }
    EXPECT_NEAR(moment / mass, 0.5 * (low_m + high_m), 20.0);
  };
  expect_layer(800.0, 1200.0);
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("top is at 2000 m")));
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("CM1's nominal heights zh")));
  file.coordinates.erase(file.coordinates.begin() + 3);
  ExpectError(file, "need the height of the model's top: add zhval, zf or ztop");
  file.variables.push_back(OfOneValue("ztop", {}, {{"units", "km"}}, 4.0));
  expect_layer(400.0 + 500.0 * 0.9, 400.0 + 1000.0 * 0.9);
  // Over flat ground the nominal heights are the heights.
  file = Cm1();
  file.variables[1] = OfOneValue("zs", {"time", "yh", "xh"}, {{"units", "m"}}, 0.0);
  expect_layer(500.0, 1000.0);
}

}  // namespace
}  // namespace thunderhead::storm_files
