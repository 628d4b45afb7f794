// Tests of files that come from WRF but are not its usual history output. Each is read with the
// right values, or refused with a reason that names the cause.
#include "storm_files/wrf_relatives.h"

#include <cmath>

#include "tests/unit/storm_files/wrf_kind_test.h"

namespace thunderhead::storm_files {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::SyntheticWrf;
using testing::WrfCell;

constexpr double kGravity_m_per_s2 = 9.81;
constexpr double kCloudPath_kg_per_m2 = 1e-3 * kDryDensity_kg_per_m3 * 4000.0;

class WrfRelativesTest : public WrfKindTest {
 protected:
  void ExpectCloud(const SyntheticWrf& file, double tolerance_kg_per_m2 = 1e-3) {
    const auto fields = Read(file);
    ASSERT_TRUE(fields.ok()) << fields.status();
    EXPECT_NEAR(ColumnPath(*fields, 0, 0, 0), kCloudPath_kg_per_m2, tolerance_kg_per_m2);
  }
};

TEST_F(WrfRelativesTest, ReadsRestartFiles) {
  SyntheticWrf file = Cloud();
  file.renamed = {{"PH", "PH_2"}, {"T", "T_2"}};
  ExpectCloud(file);
}

// The potential temperature of moist air is theta (1 + 461.6 / 287 q_v).
TEST_F(WrfRelativesTest, ReadsThePotentialTemperatureOfMoistAir) {
  SyntheticWrf file = Cloud();
  file.renamed = {{"PH", "PH_2"}, {"T", "THM_2"}};
  ExpectCloud(file);
  file.potential_temperature_K = 310.0 * (1.0 + 461.6 / 287.0 * file.vapour_kg_per_kg);
  file.numbers["USE_THETA_M"] = 1.0;
  ExpectCloud(file);
  file.renamed = {{"T", "THM"}};
  ExpectCloud(file);
  file.renamed.clear();
  file.texts["T"]["description"] = "either 1) pert moist pot temp=(1+Rv/Rd Qv)*(theta)-T0";
  ExpectCloud(file);
  // WRF 4 writes the potential temperature of dry air in T, also with USE_THETA_M.
  file.potential_temperature_K = 310.0;
  file.texts["T"]["description"] = "perturbation potential temperature theta-t0";
  ExpectCloud(file);
}

// The dry mass of a layer is (C1H (MU + MUB) + C2H) DNW / g, by the definition of the hybrid
// coordinate. PH and PHB have its heights already, so HYBRID_OPT changes nothing for the reader.
TEST_F(WrfRelativesTest, HybridLevelsKeepTheModelsDryMass) {
  constexpr double kColumn_Pa = 60'000.0;
  constexpr int kEtaLevels = 8;
  const auto eta = [](int face) { return 1.0 - static_cast<double>(face) / kEtaLevels; };
  // B(eta) of a hybrid coordinate, which is eta at the ground and falls to 0 at eta 0.2.
  const auto hybrid_b = [&](int face) {
    const double above = std::max(0.0, (eta(face) - 0.2) / 0.8);
    return above * above * (3.0 - 2.0 * above);
  };
  const auto dry_mass_kg_per_m2 = [&](int layer) {
    const double dnw = eta(layer) - eta(layer + 1);
    const double c1 = (hybrid_b(layer) - hybrid_b(layer + 1)) / dnw;
    const double c2 = (1.0 - c1) * (100'000.0 - 5000.0);
    return (c1 * kColumn_Pa + c2) * dnw / kGravity_m_per_s2;
  };
  SyntheticWrf file;
  file.levels = kEtaLevels;
  file.numbers["HYBRID_OPT"] = 2.0;
  file.interface_height_m = [&](const WrfCell& cell) {
    double height_m = 0.0;
    for (int layer = 0; layer < cell.level; ++layer) {
      height_m += dry_mass_kg_per_m2(layer) / kDryDensity_kg_per_m3;
    }
    return height_m;
  };
  file.mixing_ratios["QCLOUD"] = [](const WrfCell& cell) { return 1e-4 * (cell.level + 1); };
  double path_kg_per_m2 = 0.0;
  for (int layer = 0; layer < kEtaLevels; ++layer) {
    path_kg_per_m2 += 1e-4 * (layer + 1) * dry_mass_kg_per_m2(layer);
  }
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_NEAR(ColumnPath(*fields, 0, 0, 0) / path_kg_per_m2, 1.0, 1e-4);
}

// The output of xwrf holds eta in its vertical coordinate.
TEST_F(WrfRelativesTest, RefusesEtaInPlaceOfHeights) {
  SyntheticWrf file = Cloud();
  file.renamed_dimensions = {{"bottom_top", "z"}, {"south_north", "y"}, {"west_east", "x"}};
  file.omitted = {"PH", "PHB", "P", "PB", "T"};
  file.level_coordinate = {0.95, 0.85, 0.7, 0.5, 0.35, 0.2, 0.1, 0.05};
  file.texts["z"] = {{"standard_name", "atmosphere_hybrid_sigma_pressure_coordinate"},
                     {"units", ""},
                     {"axis", "Z"}};
  EXPECT_THAT(Message(file), AllOf(HasSubstr("vertical coordinate z counts eta"),
                                   HasSubstr("heights are needed"), HasSubstr(path_)));
}

// A file that wrf-python has written: heights of the layers' middles, pressure in hPa, temperature.
SyntheticWrf OfWrfPython() {
  SyntheticWrf file;
  file.mixing_ratios["QCLOUD"] = [](const WrfCell&) { return 1e-3; };
  file.omitted = {"PH", "PHB", "P", "PB", "T"};
  file.mixing_ratios["height"] = [](const WrfCell& cell) { return 250.0 + 500.0 * cell.level; };
  file.mixing_ratios["pressure"] = [](const WrfCell&) { return 800.0; };
  file.mixing_ratios["temp"] = [](const WrfCell&) { return 310.0 * 0.938235; };
  file.units = {{"height", "m"}, {"pressure", "hPa"}, {"temp", "K"}};
  return file;
}

TEST_F(WrfRelativesTest, ReadsTheHeightsOfWrfPython) {
  ExpectCloud(OfWrfPython());
  SyntheticWrf file = OfWrfPython();
  file.units["temp"] = "degC";
  file.mixing_ratios["temp"] = [](const WrfCell&) { return 310.0 * 0.938235 - 273.15; };
  ExpectCloud(file);
  const auto described = Describe(file);
  ASSERT_TRUE(described.ok()) << described.status();
  EXPECT_THAT(Assumptions(*described), HasSubstr("height is taken as the height"));
}

TEST_F(WrfRelativesTest, TheLowestOfMiddlesIsAboveTheGround) {
  SyntheticWrf file = OfWrfPython();
  file.terrain_m = [](int, int) { return 100.0; };
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_NEAR(ColumnPath(*fields, 0, 0, 0), 1e-3 * kDryDensity_kg_per_m3 * 3900.0, 1e-3);
}

TEST_F(WrfRelativesTest, ASingleMiddleHasNoThickness) {
  SyntheticWrf file = OfWrfPython();
  file.levels = 1;
  EXPECT_THAT(Message(file), HasSubstr("height has the height of one layer"));
}

// Programs that average WRF output in time write cell_methods as CF files have them.
TEST_F(WrfRelativesTest, VariancesAreNoAmountsOfWater) {
  SyntheticWrf file = Cloud();
  file.texts["QCLOUD"]["cell_methods"] = "Time: mean";
  const auto described = Describe(file);
  ASSERT_TRUE(described.ok()) << described.status();
  EXPECT_THAT(Assumptions(*described), HasSubstr("statistic (cell_methods 'Time: mean')"));
  // Variables with the same method share a sentence.
  file.mixing_ratios["QRAIN"] = [](const WrfCell&) { return 1e-4; };
  file.texts["QRAIN"]["cell_methods"] = "Time: mean";
  const auto both = Describe(file);
  ASSERT_TRUE(both.ok()) << both.status();
  EXPECT_THAT(Assumptions(*both), HasSubstr("QCLOUD, QRAIN are shown as the amounts"));
  file.texts["QCLOUD"]["cell_methods"] = "Time: variance";
  EXPECT_THAT(Message(file), HasSubstr("QCLOUD has cell_methods 'Time: variance'"));
}

TEST_F(WrfRelativesTest, NamesLevelsThatRunDownwards) {
  SyntheticWrf file = OfWrfPython();
  file.mixing_ratios["height"] = [](const WrfCell& cell) { return 3750.0 - 500.0 * cell.level; };
  EXPECT_THAT(Message(file), AllOf(HasSubstr("height of record 0 run downwards"),
                                   HasSubstr("reverse the order of the levels")));
}

TEST_F(WrfRelativesTest, UnitsMayBeSpelledDifferently) {
  SyntheticWrf file = OfWrfPython();
  file.units = {
      {"height", "metre"}, {"pressure", "millibars"}, {"temp", "kelvins"}, {"QCLOUD", "KG KG-1"}};
  ExpectCloud(file);
  file.units["QCLOUD"] = "kg kg(-1)";
  ExpectCloud(file);
  file.units["QCLOUD"] = "g kg-1";
  EXPECT_THAT(Message(file), HasSubstr("QCLOUD has units 'g kg-1' where 'kg kg-1' is needed"));
}

TEST_F(WrfRelativesTest, RefusesWrfPythonsFilesWithoutHeights) {
  SyntheticWrf file = OfWrfPython();
  file.mixing_ratios.erase("height");
  EXPECT_THAT(Message(file), HasSubstr("has no variable PH"));
  // A height above the ground is not one above sea level.
  file = OfWrfPython();
  file.texts["height"]["description"] = "model height - [AGL] (mass grid)";
  EXPECT_THAT(Message(file), HasSubstr("has no variable PH"));
}

TEST_F(WrfRelativesTest, PressureLevelsNeedTheirHeights) {
  SyntheticWrf file = OfWrfPython();
  file.renamed_dimensions = {{"bottom_top", "level"}};
  file.mixing_ratios.erase("pressure");
  file.level_coordinate = {800, 800, 800, 800, 800, 800, 800, 800};
  file.texts["level"]["units"] = "hPa";
  ExpectCloud(file);
  file.mixing_ratios.erase("height");
  EXPECT_THAT(Message(file), HasSubstr("has pressure levels (level in hPa) without their heights"));
}

TEST_F(WrfRelativesTest, LevelsMayBeHeights) {
  SyntheticWrf file = OfWrfPython();
  file.renamed_dimensions = {{"bottom_top", "level"}};
  file.mixing_ratios.erase("height");
  file.level_coordinate = {0.25, 0.75, 1.25, 1.75, 2.25, 2.75, 3.25, 3.75};
  file.texts["level"]["units"] = "km";
  ExpectCloud(file);
}

TEST_F(WrfRelativesTest, NamesFilesThatAreNotHistoryOutput) {
  SyntheticWrf pressure = Cloud();
  pressure.mixing_ratios.clear();
  pressure.mixing_ratios["GHT_PL"] = [](const WrfCell&) { return 1000.0; };
  EXPECT_THAT(Message(pressure), HasSubstr("WRF's output on pressure levels (GHT_PL"));

  SyntheticWrf input = Cloud();
  input.texts[""]["TITLE"] = "OUTPUT FROM METGRID V4.4";
  EXPECT_THAT(Message(input), HasSubstr("is output of METGRID"));

  SyntheticWrf without_fields = Cloud();
  without_fields.mixing_ratios.clear();
  EXPECT_THAT(Message(without_fields), HasSubstr("has none of the variables QCLOUD"));
}

TEST_F(WrfRelativesTest, RefusesOneProcessesTile) {
  SyntheticWrf file = Cloud();
  file.numbers = {{"WEST-EAST_PATCH_START_UNSTAG", 5.0},
                  {"WEST-EAST_PATCH_END_UNSTAG", 8.0},
                  {"WEST-EAST_GRID_DIMENSION", 9.0}};
  EXPECT_THAT(Message(file), HasSubstr("one process's tile of the domain (west_east 5 to 8 of 8)"));
  // A part that was cut out of a tile has another length than the tile.
  file.numbers["WEST-EAST_PATCH_END_UNSTAG"] = 7.0;
  ExpectCloud(file);
  // A part that was cut out keeps the attributes of the whole domain.
  file.numbers = {{"WEST-EAST_PATCH_START_UNSTAG", 1.0},
                  {"WEST-EAST_PATCH_END_UNSTAG", 8.0},
                  {"WEST-EAST_GRID_DIMENSION", 9.0}};
  ExpectCloud(file);
}

// A file of no format gives the reason of the nearest one.
TEST_F(WrfRelativesTest, WithoutWrfsDimensionsTheErrorIsStillThatOfWrf) {
  SyntheticWrf file;
  file.renamed_dimensions = {{"bottom_top", "lev"},
                             {"bottom_top_stag", "lev_2"},
                             {"south_north", "y"},
                             {"west_east", "x"}};
  file.omitted = {"PH", "PHB", "P", "PB", "T", "QVAPOR"};
  EXPECT_THAT(Message(file), HasSubstr("has no dimension bottom_top"));
}

}  // namespace
}  // namespace thunderhead::storm_files
