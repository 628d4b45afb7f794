#include "volume/strongest_core.h"

#include "gtest/gtest.h"
#include "volume/core_sight.h"

namespace thunderhead::volume {
namespace {

constexpr float kCloud_kg_per_m3 = 1e-3F;
constexpr float kRain_kg_per_m3 = 5e-3F;

// Returns an empty storm of 60 x 60 x 16 km with the fields cloud and rain.
HydrometeorFields Storm() {
  HydrometeorFields fields;
  fields.grid = {{60, 60, 32}, {1000.0, 1000.0, 500.0}, {-30e3, -30e3, 0.0}};
  fields.condensate = {{0, 0, 0}, fields.grid.cells};
  fields.fields.resize(2);
  fields.fields[0].hydrometeor = physics::Hydrometeor::kCloud;
  fields.fields[1].hydrometeor = physics::Hydrometeor::kRain;
  return fields;
}

void Fill(HydrometeorFields& fields, int field, const glm::ivec3& low, const glm::ivec3& high,
          float value) {
  auto& cells = fields.fields[static_cast<std::size_t>(field)].concentration_kg_per_m3;
  cells.resize(fields.grid.CellCount(), 0.0F);
  for (int z = low.z; z < high.z; ++z) {
    for (int y = low.y; y < high.y; ++y) {
      for (int x = low.x; x < high.x; ++x) cells[fields.grid.Offset(x, y, z)] = value;
    }
  }
}

TEST(StrongestCore, OfAnEmptyStormIsNothing) {
  EXPECT_FALSE(StrongestCore(Storm()).has_value());
  HydrometeorFields fields = Storm();
  fields.condensate = {};
  EXPECT_FALSE(StrongestCore(fields).has_value());
}

TEST(StrongestCore, IsTheTowerAndNotALoneColumn) {
  HydrometeorFields fields = Storm();
  // The updraught reaches from 1 to 12 km, around (5, 5) km.
  Fill(fields, 0, {33, 33, 2}, {38, 38, 24}, kCloud_kg_per_m3);
  Fill(fields, 0, {10, 10, 2}, {11, 11, 24}, 3 * kCloud_kg_per_m3);
  const auto core = StrongestCore(fields);
  ASSERT_TRUE(core.has_value());
  EXPECT_EQ(core->place_m, glm::dvec2(5.5e3, 5.5e3));
  EXPECT_EQ(core->ground_m, 0.0);
  EXPECT_EQ(core->top_m, 12e3);
}

TEST(StrongestCore, IsTheUpdraughtRatherThanTheHeavierRain) {
  HydrometeorFields fields = Storm();
  Fill(fields, 0, {30, 30, 2}, {34, 34, 24}, kCloud_kg_per_m3);
  Fill(fields, 1, {36, 30, 0}, {44, 34, 24}, 10 * kRain_kg_per_m3);
  const auto core = StrongestCore(fields);
  ASSERT_TRUE(core.has_value());
  EXPECT_NEAR(core->place_m.x, 2e3, 1e3);
}

TEST(StrongestCore, HasTheTopOfATowerThatLeans) {
  HydrometeorFields fields = Storm();
  Fill(fields, 0, {30, 30, 2}, {34, 34, 18}, kCloud_kg_per_m3);
  Fill(fields, 0, {35, 30, 12}, {39, 34, 24}, kCloud_kg_per_m3);
  const auto core = StrongestCore(fields);
  ASSERT_TRUE(core.has_value());
  EXPECT_NEAR(core->place_m.x, 2e3, 1e3);
  EXPECT_EQ(core->top_m, 12e3);
}

TEST(StrongestCore, StandsOnTheTerrain) {
  HydrometeorFields fields = Storm();
  fields.terrain_height_m.assign(fields.grid.Offset(0, 0, 1), 1500.0F);
  Fill(fields, 0, {30, 30, 4}, {34, 34, 24}, kCloud_kg_per_m3);
  const auto core = StrongestCore(fields);
  ASSERT_TRUE(core.has_value());
  EXPECT_EQ(core->ground_m, 1500.0);
  EXPECT_EQ(core->Height_m(), 10.5e3);
}

// Returns the core of a tower at the domain's middle, from 1 to 12 km.
StormCore Tower(HydrometeorFields& fields) {
  Fill(fields, 0, {28, 28, 2}, {32, 32, 24}, kCloud_kg_per_m3);
  return {{0.0, 0.0}, 0.0, 12e3};
}

TEST(CoreSight, RainHidesTheBaseBehindIt) {
  HydrometeorFields fields = Storm();
  const StormCore core = Tower(fields);
  Fill(fields, 1, {20, 34, 0}, {40, 38, 8}, kRain_kg_per_m3);
  const CoreSight sight(fields, core);
  EXPECT_EQ(sight.HiddenBase({0.0, -20e3, 2.0}), 0.0);
  EXPECT_GT(sight.HiddenBase({0.0, 20e3, 2.0}), 0.99);
  EXPECT_LT(sight.HiddenTower({0.0, -20e3, 2.0}), 0.01);
}

TEST(CoreSight, TerrainHidesWhatIsBehindIt) {
  HydrometeorFields fields = Storm();
  const StormCore core = Tower(fields);
  fields.terrain_height_m.assign(fields.grid.Offset(0, 0, 1), 0.0F);
  for (int x = 0; x < 60; ++x) fields.terrain_height_m[fields.grid.Offset(x, 40, 0)] = 4000.0F;
  const CoreSight sight(fields, core);
  EXPECT_EQ(sight.HiddenBase({0.0, -20e3, 2.0}), 0.0);
  EXPECT_EQ(sight.HiddenBase({0.0, 20e3, 2.0}), 1.0);
}

TEST(CoreSight, AnAnvilOverTheEyeHidesTheSky) {
  HydrometeorFields fields = Storm();
  const StormCore core = Tower(fields);
  Fill(fields, 0, {20, 30, 20}, {40, 55, 24}, kCloud_kg_per_m3);
  const CoreSight sight(fields, core);
  EXPECT_EQ(sight.HiddenSky({0.0, -20e3, 2.0}, 0.7), 0.0);
  EXPECT_GT(sight.HiddenSky({0.0, 20e3, 2.0}, 0.7), 0.99);
}

TEST(CoreSight, AnEyeInRainOrFogIsNotClear) {
  HydrometeorFields fields = Storm();
  const StormCore core = Tower(fields);
  Fill(fields, 1, {20, 45, 0}, {40, 55, 8}, kRain_kg_per_m3);
  const CoreSight sight(fields, core);
  EXPECT_TRUE(sight.IsClear({0.0, -20e3, 2.0}));
  EXPECT_FALSE(sight.IsClear({0.0, 20e3, 2.0}));
  Fill(fields, 0, {0, 0, 0}, {60, 20, 1}, kCloud_kg_per_m3);
  EXPECT_FALSE(sight.IsClear({0.0, -20e3, 2.0}));
}

}  // namespace
}  // namespace thunderhead::volume
