// Effective radii and numbers of particles from synthetic files: extinction by cell keeps each
// column's optical depth through the remapping.
#include "volume/particle_sizes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "physics/particle_size.h"
#include "tests/support/synthetic_wrf.h"
#include "tests/support/temporary_folder.h"
#include "volume/wrf_reader.h"

namespace thunderhead::volume {
namespace {

using physics::Hydrometeor;
using testing::SyntheticWrf;
using testing::WrfCell;

// Density of SyntheticWrf's air (see layer_air_test).
constexpr double kDensity_kg_per_m3 = 0.94321;

class ParticleSizesTest : public ::testing::Test {
 protected:
  HydrometeorFields Read(const SyntheticWrf& file) {
    const std::string path = folder_.File("wrfout");
    testing::WriteWrf(file, path);
    const auto metadata = ReadWrfMetadata(path);
    EXPECT_TRUE(metadata.ok()) << metadata.status();
    auto fields = ReadWrfTime(*metadata, 0, std::nullopt, {});
    EXPECT_TRUE(fields.ok()) << fields.status();
    return *std::move(fields);
  }

  testing::TemporaryFolder folder_;
};

// The optical depth of a column if `mass_extinction` holds.
double ColumnDepth(const HydrometeorFields& fields, const MassExtinction& mass_extinction, int x,
                   int y) {
  double depth = 0.0;
  for (int z = 0; z < fields.grid.cells.z; ++z) {
    float sum = 0.0F;
    AddExtinction(fields.fields[0], mass_extinction, fields.grid.Offset(x, y, z), 1, &sum);
    depth += sum * fields.grid.spacing_m.z;
  }
  return depth;
}

// A cloud over sloping ground whose droplets grow with height.
double MixingRatio(const WrfCell& cell) { return 1e-4 * (1 + cell.level % 5); }
double Radius_m(const WrfCell& cell) { return 2e-6 * (1 + cell.level) * (1 + 0.1 * cell.x); }

SyntheticWrf SizedCloud() {
  SyntheticWrf file;
  file.nx = 7;
  file.levels = 24;
  file.terrain_m = [](int x, int y) { return 130.0 * x + 20.0 * y; };
  file.mixing_ratios["QCLOUD"] = MixingRatio;
  file.mixing_ratios["RE_CLOUD"] = Radius_m;
  file.units["RE_CLOUD"] = "m";
  return file;
}

TEST_F(ParticleSizesTest, ColumnsKeepTheOpticalDepthOfTheirLayers) {
  const SyntheticWrf file = SizedCloud();
  const HydrometeorFields fields = Read(file);
  const HydrometeorField& cloud = fields.fields[0];
  EXPECT_EQ(cloud.sizes.variable, "RE_CLOUD");
  const auto& optics = physics::DefaultOptics(Hydrometeor::kCloud);
  const MassExtinction by_cell = MassExtinctionOf(cloud, optics, true);
  EXPECT_TRUE(by_cell.by_cell);
  for (int y = 0; y < file.ny; ++y) {
    for (int x = 0; x < file.nx; ++x) {
      double expected = 0.0;
      for (int level = 0; level < file.levels; ++level) {
        const WrfCell cell{x, y, level, 0};
        const double thickness_m =
            InterfaceHeight_m(file, {x, y, level + 1, 0}) - InterfaceHeight_m(file, cell);
        expected += 3.0 * kDensity_kg_per_m3 * MixingRatio(cell) / (2.0 * 1000.0 * Radius_m(cell)) *
                    thickness_m;
      }
      EXPECT_NEAR(ColumnDepth(fields, by_cell, x, y) / expected, 1.0, 1e-3) << x << " " << y;
    }
  }
}

TEST_F(ParticleSizesTest, CanBeSwitchedOff) {
  const HydrometeorFields fields = Read(SizedCloud());
  const auto& optics = physics::DefaultOptics(Hydrometeor::kCloud);
  const MassExtinction constant = MassExtinctionOf(fields.fields[0], optics, false);
  EXPECT_FALSE(constant.by_cell);
  EXPECT_FLOAT_EQ(constant.m2_per_kg, 150.0F);
  EXPECT_EQ(WithDrawnRadius(fields.fields[0], optics, false).radius_m, 1e-5F);
  const float mean_m = fields.fields[0].sizes.mean_radius_m;
  EXPECT_EQ(WithDrawnRadius(fields.fields[0], optics, true).radius_m, mean_m);
  EXPECT_GT(mean_m, 2e-6F);
  EXPECT_LT(mean_m, 8e-5F);
}

TEST_F(ParticleSizesTest, FollowFromNumbers) {
  SyntheticWrf file;
  file.mixing_ratios["QRAIN"] = [](const WrfCell&) { return 1e-3; };
  file.mixing_ratios["QNRAIN"] = [](const WrfCell& cell) { return cell.x == 0 ? 0.0 : 2000.0; };
  file.units["QNRAIN"] = "  kg(-1)";
  const HydrometeorFields fields = Read(file);
  const HydrometeorField& rain = fields.fields[0];
  EXPECT_EQ(rain.sizes.variable, "QNRAIN");
  const double expected_m = physics::EffectiveRadius_m(Hydrometeor::kRain, 5e-7F);
  const std::size_t counted = fields.grid.Offset(1, 1, 3);
  EXPECT_NEAR(InverseRadius_per_m(rain.sizes.inverse_radius[counted]) * expected_m, 1.0, 1e-3);
  // No drops are counted there: the constant radius.
  const std::size_t uncounted = fields.grid.Offset(0, 1, 3);
  EXPECT_NEAR(InverseRadius_per_m(rain.sizes.inverse_radius[uncounted]) * 1e-3, 1.0, 1e-3);
}

TEST_F(ParticleSizesTest, RadiiComeBeforeNumbers) {
  SyntheticWrf file = SizedCloud();
  file.mixing_ratios["QNCLOUD"] = [](const WrfCell&) { return 1e8; };
  file.units["QNCLOUD"] = "kg-1";
  EXPECT_EQ(Read(file).fields[0].sizes.variable, "RE_CLOUD");
  file.units["RE_CLOUD"] = "furlong";
  EXPECT_EQ(Read(file).fields[0].sizes.variable, "QNCLOUD") << "unfit variables are left out";
}

TEST_F(ParticleSizesTest, NonsenseGivesTheConstantRadius) {
  for (const double radius_m : {0.0, -1.0, 1e-8, 5.0, std::numeric_limits<double>::quiet_NaN(),
                                std::numeric_limits<double>::infinity()}) {
    SyntheticWrf file = SizedCloud();
    file.mixing_ratios["RE_CLOUD"] = [=](const WrfCell& cell) {
      return cell.x == 3 ? 2e-5 : radius_m;
    };
    const HydrometeorFields fields = Read(file);
    const ParticleSizes& sizes = fields.fields[0].sizes;
    const auto radius_at = [&](int x) {
      return 1.0F / InverseRadius_per_m(sizes.inverse_radius[fields.grid.Offset(x, 1, 12)]);
    };
    EXPECT_NEAR(radius_at(1), 1e-5F, 1e-8F) << radius_m;
    EXPECT_NEAR(radius_at(3), 2e-5F, 2e-8F) << radius_m;
  }
}

TEST_F(ParticleSizesTest, NothingIsHeldWithoutThem) {
  SyntheticWrf file = SizedCloud();
  const HydrometeorFields sized = Read(file);
  file.omitted = {"RE_CLOUD"};
  const HydrometeorFields plain = Read(file);
  EXPECT_TRUE(plain.fields[0].sizes.Empty());
  EXPECT_EQ(plain.fields[0].sizes.variable, "");
  EXPECT_EQ(sized.Bytes() - plain.Bytes(), sized.grid.CellCount() * sizeof(std::uint16_t));
  const auto& optics = physics::DefaultOptics(Hydrometeor::kCloud);
  EXPECT_FALSE(MassExtinctionOf(plain.fields[0], optics, true).by_cell);
}

TEST(InverseRadius, HalvesHoldEveryRadiusThatASceneMayHave) {
  for (double radius_m = physics::kMinRadius_m; radius_m <= physics::kMaxRadius_m;
       radius_m *= 1.07) {
    const auto per_radius = static_cast<float>(1.0 / radius_m);
    const ParticleSizes sizes = SizesOf("RE_CLOUD", {2e-3F}, {2e-3F * per_radius});
    EXPECT_NEAR(InverseRadius_per_m(sizes.inverse_radius[0]) * radius_m, 1.0, 6e-4) << radius_m;
  }
}

}  // namespace
}  // namespace thunderhead::volume
