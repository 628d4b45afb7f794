// Tests of the ground below layers: heights that are missing or impossible are refused in files of
// all formats, and layers below the ground are empty.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "storm_files/ground.h"
#include "tests/unit/storm_files/cf_file_test.h"
#include "tests/unit/storm_files/wrf_kind_test.h"

// Tests are compiled together, and other tests have the same names.
namespace thunderhead::storm_files::ground_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::SyntheticCf;
using testing::SyntheticWrf;
using testing::WrfCell;

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();
constexpr double kCloud_kg_per_m3 = 1e-4;

TEST(Ground, IsThatOfTheEarth) {
  EXPECT_TRUE(CheckGround("f", {}, 2).ok());
  EXPECT_TRUE(CheckGround("f", {-431.0F, 8849.0F, kMissing, 0.0F}, 2).ok());
  for (const float wrong_m : {-501.0F, 9001.0F, 1e6F, std::numeric_limits<float>::infinity()}) {
    const std::string message(CheckGround("f", {0.0F, 0.0F, 0.0F, wrong_m}, 2).message());
    EXPECT_THAT(message, HasSubstr("m in column (1, 1), which is not from -500 to 9000 m"));
  }
  EXPECT_THAT(std::string(CheckGround("f", {kMissing, kMissing}, 2).message()),
              HasSubstr("f is missing in every column"));
}

TEST(Ground, MayBeMissingOnlyOutsideTheDomain) {
  const std::vector<float> ground_m = {0.0F, kMissing, 0.0F, kMissing};
  EXPECT_TRUE(CheckGroundBelow("f", ground_m,
                               {1.0F, kMissing, 1.0F, kMissing, 1.0F, kMissing, 1.0F, kMissing}, 2)
                  .ok());
  const auto refused =
      CheckGroundBelow("f", ground_m, {1.0F, kMissing, 1.0F, kMissing, 1.0F, 0.0F, 1.0F, 0.0F}, 2);
  EXPECT_THAT(std::string(refused.message()),
              HasSubstr("f is missing in 2 of 4 columns, the first of which is column (1, 0)"));
}

TEST(Ground, RaisesInterfacesButNotAboveTheirTop) {
  std::vector<float> height_m = {0.0F, 0.0F, 0.0F, 500.0F, 500.0F, 500.0F, 900.0F, 900.0F, 900.0F};
  EXPECT_TRUE(RaiseToGround({700.0F, kMissing, 1000.0F}, height_m));
  EXPECT_THAT(height_m,
              ElementsAre(700.0F, 0.0F, 900.0F, 700.0F, 500.0F, 900.0F, 900.0F, 900.0F, 900.0F));
  EXPECT_FALSE(RaiseToGround({700.0F, kMissing, 900.0F}, height_m));
  EXPECT_FALSE(RaiseToGround({}, height_m));
}

class CfGround : public CfFileTest {
 protected:
  // Returns cloud in all of 6 x 4 columns up to 2 km, above the given ground. The vertical
  // coordinate has the standard name `heights`.
  static SyntheticCf Cloud(const std::string& heights,
                           const std::function<double(std::size_t x, std::size_t y)>& ground_m) {
    SyntheticCf file = testing::ExtinctionFile(6, 4, 4, 1000.0, 1000.0, 500.0, {});
    file.variables[0] = {"qc", {"z", "y", "x"}, {{"units", "kg m-3"}}, [](const Index&) {
                           return kCloud_kg_per_m3;
                         }};
    file.coordinates[2].attributes["standard_name"] = heights;
    file.variables.push_back(
        {"zs",
         {"y", "x"},
         {{"standard_name", "surface_altitude"}, {"units", "m"}},
         [ground_m](const Index& at) { return ground_m(at.at("x"), at.at("y")); }});
    return file;
  }

  static float At(const volume::HydrometeorFields& fields, int x, int z) {
    return fields.fields[0].concentration_kg_per_m3[fields.grid.Offset(x, 0, z)];
  }
};

TEST_F(CfGround, MissingOrImpossibleHeightsAreRefused) {
  for (const char* heights : {"altitude", "height"}) {
    const auto everywhere = [&](double ground_m) {
      return Cloud(heights, [=](std::size_t, std::size_t) { return ground_m; });
    };
    ExpectError(everywhere(std::nan("")),
                "zs, the height of the ground, of record 0 is missing in "
                "every column; write heights above sea level");
    ExpectError(everywhere(9.96921e36), "is missing in every column");
    ExpectError(everywhere(1e6),
                "zs, the height of the ground, of record 0 is 1e+06 m in column "
                "(0, 0), which is not from -500 to 9000 m");
    ExpectError(everywhere(-5000.0), "is -5000 m in column (0, 0)");
    ExpectError(
        Cloud(heights,
              [](std::size_t x, std::size_t y) { return x == 2 && y > 1 ? std::nan("") : 100.0; }),
        "is missing in 2 of 24 columns, the first of which is column (2, 2)");
  }
}

// Outside the model's domain, neither the ground nor the fields have values.
TEST_F(CfGround, MayBeMissingWhereTheFieldsAreMissing) {
  for (const char* heights : {"altitude", "height"}) {
    SyntheticCf file =
        Cloud(heights, [](std::size_t x, std::size_t) { return x == 0 ? std::nan("") : 0.0; });
    file.variables[0].value = [](const Index& at) {
      return at.at("x") == 0 ? std::nan("") : kCloud_kg_per_m3;
    };
    const auto fields = Read(file);
    ASSERT_TRUE(fields.ok()) << fields.status();
    EXPECT_EQ(At(**fields, 0, 0), 0.0F);
    EXPECT_FLOAT_EQ(At(**fields, 1, 0), static_cast<float>(kCloud_kg_per_m3));
  }
}

// The ground is at 0, 500, 750, 2000, 2500 and 0.03 m. The cells of 500 m stay as they are.
TEST_F(CfGround, LayersOfAnAltitudeBelowItAreEmpty) {
  const std::vector<double> ground_m = {0.0, 500.0, 750.0, 2000.0, 2500.0, 0.03};
  const SyntheticCf file =
      Cloud("altitude", [&](std::size_t x, std::size_t) { return ground_m[x]; });
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_DOUBLE_EQ((*fields)->grid.low_corner_m.z, 0.0);
  EXPECT_DOUBLE_EQ((*fields)->grid.spacing_m.z, 500.0);
  EXPECT_EQ((*fields)->grid.cells.z, 4);
  const std::vector<std::vector<double>> shares = {{1, 1, 1, 1}, {0, 1, 1, 1}, {0, 0.5, 1, 1},
                                                   {0, 0, 0, 0}, {0, 0, 0, 0}, {1, 1, 1, 1}};
  double mean_path = 0.0;
  for (int x = 0; x < 6; ++x) {
    EXPECT_FLOAT_EQ((*fields)->terrain_height_m[static_cast<std::size_t>(x)],
                    static_cast<float>(ground_m[static_cast<std::size_t>(x)]));
    for (int z = 0; z < 4; ++z) {
      const double share = shares[static_cast<std::size_t>(x)][static_cast<std::size_t>(z)];
      EXPECT_FLOAT_EQ(At(**fields, x, z), static_cast<float>(share * kCloud_kg_per_m3));
      mean_path += share * kCloud_kg_per_m3 * 500.0 / 6.0;
    }
  }
  EXPECT_NEAR((*fields)->fields[0].statistics.mean_water_path_kg_per_m2, mean_path, 1e-7);
  EXPECT_NEAR((*fields)->fields[0].statistics.maximum_water_path_kg_per_m2, 0.2, 1e-7);
}

// An array with the same heights gives the same water above the ground.
TEST_F(CfGround, HidesAsMuchOfAnAxisAsOfAnArray) {
  const std::vector<double> ground_m = {0.0, 500.0, 750.0, 1200.0, 1800.0, 100.0};
  const auto ground = [&](std::size_t x, std::size_t) { return ground_m[x]; };
  for (const bool even : {true, false}) {
    const std::vector<double> faces_m = even ? std::vector<double>{0, 500, 1000, 1500, 2000}
                                             : std::vector<double>{0, 200, 600, 1200, 2000};
    SyntheticCf on_axis = Cloud("altitude", ground);
    on_axis.coordinates[2].faces = faces_m;
    for (std::size_t z = 0; z < 4; ++z) {
      on_axis.coordinates[2].values[z] = 0.5 * (faces_m[z] + faces_m[z + 1]);
    }
    SyntheticCf in_array = Cloud("altitude", ground);
    in_array.coordinates[2] = {"z", {1, 2, 3, 4}, {{"axis", "Z"}, {"positive", "up"}}, {}};
    in_array.coordinates.push_back({"z_2", {0, 1, 2, 3, 4}, {{"axis", "Z"}}, {}});
    in_array.variables.push_back(
        {"z_ifc", {"z_2", "y", "x"}, {{"units", "m"}}, [&](const Index& at) {
           return faces_m[at.at("z_2")];
         }});
    for (const SyntheticCf* file : {&on_axis, &in_array}) {
      const auto fields = Read(*file);
      ASSERT_TRUE(fields.ok()) << fields.status();
      const auto& grid = (*fields)->grid;
      for (int x = 0; x < 6; ++x) {
        double path = 0.0;
        for (int z = 0; z < grid.cells.z; ++z) path += At(**fields, x, z) * grid.spacing_m.z;
        const double expected = (2000.0 - ground_m[static_cast<std::size_t>(x)]) * kCloud_kg_per_m3;
        EXPECT_NEAR(path, expected, 1e-6) << even << " " << x;
      }
    }
  }
}

TEST_F(CfGround, AboveAllLayersIsRefused) {
  ExpectError(Cloud("altitude", [](std::size_t, std::size_t) { return 2100.0; }),
              "zs, the height of the ground, of record 0 is above all layers (z)");
}

class WrfGround : public WrfKindTest {};

TEST_F(WrfGround, MissingOrImpossibleHeightsAreRefused) {
  SyntheticWrf file = Cloud();
  file.stored_values = {{"HGT", {.x = 2, .y = 1}, 1e6}};
  EXPECT_THAT(Message(file), HasSubstr("HGT, the height of the ground, of record 0 is 1e+06 m in "
                                       "column (2, 1)"));
  file.stored_values = {{"HGT", {.x = 2, .y = 1}, std::nan("")}};
  EXPECT_THAT(Message(file), HasSubstr("is missing in 1 of 12 columns, the first of which is "
                                       "column (2, 1)"));
  file.stored_values = {};
  file.unwritten = {"HGT"};
  EXPECT_THAT(Message(file), HasSubstr("HGT, the height of the ground, of record 0 is missing in "
                                       "every column"));
}

// Levels of wrf-python that lie below the ground are empty, as pressure levels do below mountains.
TEST_F(WrfGround, LayersBelowItAreEmpty) {
  SyntheticWrf file = Cloud();
  file.omitted = {"PH", "PHB", "P", "PB", "T"};
  file.mixing_ratios["height"] = [](const WrfCell& cell) { return 250.0 + 500.0 * cell.level; };
  file.mixing_ratios["pressure"] = [](const WrfCell&) { return 800.0; };
  file.mixing_ratios["temp"] = [](const WrfCell&) { return 310.0 * 0.938235; };
  file.units = {{"height", "m"}, {"pressure", "hPa"}, {"temp", "K"}};
  file.terrain_m = [](int, int) { return 1250.0; };
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_NEAR(ColumnPath(*fields, 0, 0, 0), 1e-3 * kDryDensity_kg_per_m3 * 2750.0, 1e-3);
}

}  // namespace
}  // namespace thunderhead::storm_files::ground_test
