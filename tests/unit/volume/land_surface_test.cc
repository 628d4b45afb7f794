#include "volume/land_surface.h"

#include <cmath>

#include "glm/geometric.hpp"
#include "gtest/gtest.h"
#include "storm_files/wrf_metadata.h"
#include "storm_files/wrf_reader.h"
#include "tests/support/synthetic_wrf.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::volume {
namespace {

using testing::SyntheticWrf;
using testing::WrfCell;

float Luminance(const glm::vec3& rgb) {
  return glm::dot(rgb, glm::vec3(0.2126F, 0.7152F, 0.0722F));
}

// Returns a coast: the west is sea, the east is forest, and the north of the forest is under snow.
SyntheticWrf Coast() {
  SyntheticWrf file;
  file.nx = 10;
  file.ny = 8;
  file.mixing_ratios["QCLOUD"] = [](const WrfCell&) { return 1e-3; };
  file.land_use_table = "USGS";
  file.columns["LU_INDEX"] = [](const WrfCell& cell) { return cell.x < 5 ? 16.0 : 14.0; };
  file.columns["XLAND"] = [](const WrfCell& cell) { return cell.x < 5 ? 2.0 : 1.0; };
  file.columns["ALBEDO"] = [](const WrfCell& cell) {
    return cell.x < 5 ? 0.08 : cell.y < 4 ? 0.12 : 0.5;
  };
  file.columns["SNOWC"] = [](const WrfCell& cell) {
    return cell.x >= 5 && cell.y >= 4 ? 1.0 : 0.0;
  };
  return file;
}

class LandSurfaceTest : public ::testing::Test {
 protected:
  HydrometeorFields Read(const SyntheticWrf& file, std::size_t record = 0) {
    const std::string path = folder_.File("wrfout.nc");
    WriteWrf(file, path);
    const auto metadata = storm_files::ReadWrfMetadata(path);
    EXPECT_TRUE(metadata.ok()) << metadata.status();
    auto fields = storm_files::ReadWrfTime(*metadata, record, std::nullopt, {});
    EXPECT_TRUE(fields.ok()) << fields.status();
    return *std::move(fields);
  }

  testing::TemporaryFolder folder_;
};

TEST_F(LandSurfaceTest, HasWaterForestAndSnow) {
  const HydrometeorFields fields = Read(Coast());
  ASSERT_EQ(fields.land.texels.size(), 80U);
  const LandSample sea = LandAt(fields.land, fields.grid, {-3000.0, 0.0});
  EXPECT_EQ(sea.water, 1.0F);
  const LandSample forest = LandAt(fields.land, fields.grid, {3000.0, -5000.0});
  EXPECT_EQ(forest.water, 0.0F);
  // The tolerance covers that a colour is stored with eight bits a channel.
  EXPECT_NEAR(Luminance(forest.reflectance), 0.12F, 0.003F);
  EXPECT_GT(forest.reflectance.y, 1.3F * forest.reflectance.x);
  const LandSample snow = LandAt(fields.land, fields.grid, {3000.0, 5000.0});
  EXPECT_NEAR(Luminance(snow.reflectance), 0.5F, 0.005F);
  EXPECT_NEAR(snow.reflectance.x, snow.reflectance.z, 0.06F);
  EXPECT_NEAR(fields.land.mean_albedo, 0.5 * 0.08 + 0.25 * 0.12 + 0.25 * 0.5, 0.002);
}

// The coast lies halfway between the middles of the columns on either side, within a tenth of a
// cell. The land's colour continues below the water, so that interpolation gives no third colour at
// the coast.
TEST_F(LandSurfaceTest, TheCoastIsWhereHalfIsWater) {
  const HydrometeorFields fields = Read(Coast());
  EXPECT_EQ(LandAt(fields.land, fields.grid, {-80.0, -5000.0}).water, 1.0F);
  EXPECT_NEAR(LandAt(fields.land, fields.grid, {0.0, -5000.0}).water, 0.5F, 0.01F);
  EXPECT_EQ(LandAt(fields.land, fields.grid, {80.0, -5000.0}).water, 0.0F);
  EXPECT_NEAR(Luminance(LandAt(fields.land, fields.grid, {10.0, -5000.0}).reflectance), 0.12F,
              0.003F);
}

TEST_F(LandSurfaceTest, BeyondTheDomainItFadesToItsMean) {
  const HydrometeorFields fields = Read(Coast());
  const LandSample far = LandAt(fields.land, fields.grid, {500e3, 0.0});
  EXPECT_EQ(far.water, 0.0F);
  EXPECT_NEAR(glm::distance(far.reflectance, fields.land.mean_reflectance), 0.0F, 1e-4F);
  EXPECT_EQ(LandAt(fields.land, fields.grid, {-500e3, 0.0}).water, 1.0F);
}

TEST_F(LandSurfaceTest, SnowIsThatOfTheTimeThatIsRead) {
  SyntheticWrf file = Coast();
  file.times = {"2013-05-20_20:00:00", "2013-05-20_21:00:00"};
  file.columns.erase("ALBEDO");
  file.columns["SNOWC"] = [](const WrfCell& cell) { return cell.record == 1 ? 1.0 : 0.0; };
  const auto seen = [&](std::size_t record) {
    const HydrometeorFields fields = Read(file, record);
    return Luminance(LandAt(fields.land, fields.grid, {3000.0, 0.0}).reflectance);
  };
  EXPECT_NEAR(seen(0), 0.12F, 0.003F);
  EXPECT_NEAR(seen(1), 0.7F, 0.01F);
}

TEST_F(LandSurfaceTest, TakesDepthWhereSnowsShareIsLeftOut) {
  SyntheticWrf file = Coast();
  file.columns.erase("ALBEDO");
  file.columns.erase("SNOWC");
  file.columns["SNOWH"] = [](const WrfCell&) { return 0.5; };
  const HydrometeorFields fields = Read(file);
  EXPECT_NEAR(Luminance(LandAt(fields.land, fields.grid, {3000.0, 0.0}).reflectance), 0.7F, 0.01F);
}

TEST_F(LandSurfaceTest, LeavesOutWhatIsInOtherUnits) {
  SyntheticWrf file = Coast();
  file.columns.erase("ALBEDO");
  file.columns.erase("SNOWC");
  file.columns["SNOWH"] = [](const WrfCell&) { return 0.5; };
  const auto seen = [&] {
    const HydrometeorFields fields = Read(file);
    return Luminance(LandAt(fields.land, fields.grid, {3000.0, 0.0}).reflectance);
  };
  file.units["SNOWH"] = "m";
  EXPECT_NEAR(seen(), 0.7F, 0.01F);
  file.units["SNOWH"] = "cm";
  EXPECT_NEAR(seen(), 0.12F, 0.003F);
}

TEST_F(LandSurfaceTest, TakesMaskOrClassWhereXlandIsLeftOut) {
  SyntheticWrf file = Coast();
  file.columns.erase("XLAND");
  HydrometeorFields fields = Read(file);
  EXPECT_EQ(LandAt(fields.land, fields.grid, {-3000.0, 0.0}).water, 1.0F);
  EXPECT_EQ(LandAt(fields.land, fields.grid, {3000.0, 0.0}).water, 0.0F);
  file.columns["LANDMASK"] = [](const WrfCell& cell) { return cell.x < 2 ? 0.0 : 1.0; };
  fields = Read(file);
  EXPECT_EQ(LandAt(fields.land, fields.grid, {-4500.0, 0.0}).water, 1.0F);
  EXPECT_EQ(LandAt(fields.land, fields.grid, {-1500.0, 0.0}).water, 0.0F);
}

TEST_F(LandSurfaceTest, TheTableOfClassesFollowsFromItsNameElseFromItsSize) {
  SyntheticWrf file = Coast();
  file.columns.erase("XLAND");
  file.columns["LU_INDEX"] = [](const WrfCell&) { return 17.0; };  // MODIS's class of water
  const auto water = [&] {
    const HydrometeorFields fields = Read(file);
    return LandAt(fields.land, fields.grid, {0.0, 0.0}).water;
  };
  EXPECT_EQ(water(), 0.0F);
  file.land_use_table = "MODIFIED_IGBP_MODIS_NOAH";
  EXPECT_EQ(water(), 1.0F);
  file.land_use_table = "";
  file.land_use_classes = 21;
  EXPECT_EQ(water(), 1.0F);
  file.land_use_classes = 24;
  EXPECT_EQ(water(), 0.0F);
  file.land_use_classes = 40;
  EXPECT_TRUE(Read(file).land.Empty());
}

TEST_F(LandSurfaceTest, ThereIsNoneWithoutClassesOrPlace) {
  SyntheticWrf file = Coast();
  file.columns.erase("LU_INDEX");
  EXPECT_TRUE(Read(file).land.Empty());
  file = Coast();
  file.map_projection = 0;
  EXPECT_TRUE(Read(file).land.Empty());
}

TEST_F(LandSurfaceTest, MissingValuesAreThoseOfTheClass) {
  SyntheticWrf file = Coast();
  for (const char* name : {"ALBEDO", "XLAND", "SNOWC"}) {
    file.stored_values.push_back({name, {8, 1, 0, 0}, 1e35});
  }
  const HydrometeorFields fields = Read(file);
  const LandSample there = LandAt(fields.land, fields.grid, {3500.0, -5000.0});
  EXPECT_EQ(there.water, 0.0F);
  EXPECT_NEAR(Luminance(there.reflectance), 0.12F, 0.003F);
}

}  // namespace
}  // namespace thunderhead::volume
