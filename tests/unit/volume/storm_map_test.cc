#include "volume/storm_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "volume/air_density.h"
#include "volume/field_values.h"

namespace thunderhead::volume {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// Returns an empty storm of 6 x 4 columns, each 1 km wide, with 5 levels of 200 m that begin at a
// height of 100 m.
HydrometeorFields Empty(std::initializer_list<physics::Hydrometeor> hydrometeors,
                        Quantity quantity) {
  HydrometeorFields fields;
  fields.grid = {{6, 4, 5}, {1000.0, 1000.0, 200.0}, {-3000.0, -2000.0, 100.0}};
  fields.condensate = {{0, 0, 0}, fields.grid.cells};
  for (const physics::Hydrometeor hydrometeor : hydrometeors) {
    HydrometeorField field;
    field.hydrometeor = hydrometeor;
    field.quantity = quantity;
    field.concentration_kg_per_m3.assign(fields.grid.CellCount(), 0.0F);
    fields.fields.push_back(field);
  }
  fields.terrain_height_m.assign(24, 100.0F);
  return fields;
}

float& At(HydrometeorFields& fields, std::size_t field, int x, int y, int z) {
  return fields.fields[field].concentration_kg_per_m3[fields.grid.Offset(x, y, z)];
}

TEST(StormMapTest, AColumnsPathIsTheSumOfItsCells) {
  HydrometeorFields fields = Empty({physics::Hydrometeor::kCloud, physics::Hydrometeor::kGraupel},
                                   Quantity::kMassConcentration);
  At(fields, 0, 5, 3, 0) = 0.001F;
  At(fields, 0, 5, 3, 4) = 0.002F;
  At(fields, 1, 5, 3, 2) = 0.004F;
  const StormMap both = MapOf(fields, {{0, 1}, 192, false});
  EXPECT_EQ(both.size_px, glm::ivec2(6, 4));
  EXPECT_FLOAT_EQ(both.values[23], (0.001F + 0.002F + 0.004F) * 200.0F);
  EXPECT_EQ(std::accumulate(both.values.begin(), both.values.end(), -both.values[23]), 0.0F);
  EXPECT_THAT(both.terrain_height_m, IsEmpty());
  const StormMap cloud = MapOf(fields, {{0}, 192, false});
  EXPECT_FLOAT_EQ(cloud.values[23], 0.003F * 200.0F);
  EXPECT_THAT(cloud.peaks, SizeIs(2)) << "of every field";
}

TEST(StormMapTest, PeaksAreCellsAndColumnsMiddles) {
  HydrometeorFields fields = Empty({physics::Hydrometeor::kCloud, physics::Hydrometeor::kGraupel},
                                   Quantity::kMassConcentration);
  At(fields, 1, 1, 2, 3) = 0.004F;
  for (int z = 0; z < 3; ++z) At(fields, 1, 4, 0, z) = 0.002F;
  const StormMap map = MapOf(fields, {{}, 192, false});
  EXPECT_EQ(map.peaks[0].value, 0.0F);
  EXPECT_EQ(map.peaks[0].column_kg_per_m2, 0.0);
  const FieldPeak& graupel = map.peaks[1];
  EXPECT_EQ(graupel.index, 1U);
  EXPECT_EQ(graupel.value, 0.004F);
  EXPECT_FLOAT_EQ(static_cast<float>(graupel.kg_per_m3), 0.004F);
  EXPECT_EQ(graupel.position_m, glm::dvec3(-1500.0, 500.0, 800.0));
  EXPECT_NEAR(graupel.column_kg_per_m2, 3 * 0.002 * 200.0, 1e-6);
  EXPECT_EQ(graupel.column_position_m, glm::dvec2(1500.0, -1500.0));
  EXPECT_THAT(map.values, ::testing::Each(0.0F)) << "none was asked for";
}

TEST(StormMapTest, TheLargestMixingRatioMayBeInThinnerAir) {
  HydrometeorFields fields = Empty({physics::Hydrometeor::kSnow}, Quantity::kMixingRatio);
  fields.air = {{1, 1}, {1.2F, 1.1F, 1.0F, 0.5F, 0.4F}};
  At(fields, 0, 2, 2, 0) = 0.0012F;  // the mixing ratio is 1 g/kg
  At(fields, 0, 3, 2, 4) = 0.0010F;  // the mixing ratio is 2.5 g/kg
  const FieldPeak peak = MapOf(fields, {{0}, 192, false}).peaks[0];
  EXPECT_FLOAT_EQ(peak.value, 0.0025F);
  EXPECT_FLOAT_EQ(static_cast<float>(peak.kg_per_m3), 0.0010F);
  EXPECT_EQ(peak.position_m.z, 1000.0);
  EXPECT_EQ(peak.column_position_m.x, -500.0);
  fields.air = {};
  EXPECT_EQ(QuantityOf(fields, fields.fields[0]), Quantity::kMassConcentration);
  EXPECT_EQ(MapOf(fields, {{0}, 192, false}).peaks[0].value, 0.0012F);
}

TEST(StormMapTest, ASmallerMapKeepsTheMassOfTheDomain) {
  HydrometeorFields fields = Empty({physics::Hydrometeor::kRain}, Quantity::kMassConcentration);
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 6; ++x) At(fields, 0, x, y, 1) = 0.001F * static_cast<float>(1 + x + 6 * y);
  }
  for (const int size : {1, 2, 3, 4, 5}) {
    const StormMap map = MapOf(fields, {{0}, size, true});
    EXPECT_EQ(map.size_px.x, size);
    ASSERT_EQ(map.values.size(), static_cast<std::size_t>(map.size_px.x * map.size_px.y));
    const double mean = std::accumulate(map.values.begin(), map.values.end(), 0.0) /
                        static_cast<double>(map.values.size());
    EXPECT_NEAR(mean, 0.001 * 12.5 * 200.0, 1e-6) << size;
    EXPECT_EQ(map.terrain_height_m.size(), map.values.size());
    EXPECT_FLOAT_EQ(map.terrain_height_m[0], 100.0F);
  }
  // A pixel covers two columns, and rows count from the south.
  const StormMap half = MapOf(fields, {{0}, 3, false});
  EXPECT_EQ(half.size_px, glm::ivec2(3, 2));
  EXPECT_FLOAT_EQ(half.values[0], 0.001F * (1 + 2 + 7 + 8) / 4.0F * 200.0F);
  EXPECT_FLOAT_EQ(half.values[5], 0.001F * (17 + 18 + 23 + 24) / 4.0F * 200.0F);
}

TEST(StormMapTest, PixelsTakeTheirShareOfColumns) {
  EXPECT_THAT(Resampled({1.0, 2.0, 6.0}, {3, 1}, {2, 1}),
              ElementsAre(::testing::DoubleNear((1.0 + 0.5 * 2.0) / 1.5, 1e-12),
                          ::testing::DoubleNear((0.5 * 2.0 + 6.0) / 1.5, 1e-12)));
  EXPECT_THAT(Resampled({1.0, 2.0, 6.0}, {1, 3}, {1, 1}),
              ElementsAre(::testing::DoubleNear(3.0, 1e-12)));
}

TEST(AirDensityTest, MeansAreByBlocksAndLevels) {
  const RegularGrid grid{{4, 2, 3}, {1000.0, 1000.0, 100.0}, {0.0, 0.0, 50.0}};
  AirDensityMeans means(grid);
  EXPECT_EQ(means.Stride(), glm::ivec2(1));
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 4; ++x) {
      means.Add(x, y, 50.0, 200.0, 1.0F + 0.1F * static_cast<float>(x));
      means.Add(x, y, 200.0, 400.0, 0.8F);
      means.Add(x, y, 200.0, 400.0, std::nanf(""));
    }
  }
  const AirDensity air = means.Means();
  ASSERT_EQ(air.blocks, glm::ivec2(4, 2));
  EXPECT_FLOAT_EQ(air.At(grid, 0, 0, 0), 1.0F);
  EXPECT_FLOAT_EQ(air.At(grid, 3, 1, 0), 1.3F);
  EXPECT_FLOAT_EQ(air.At(grid, 0, 0, 1), 0.9F) << "half of either";
  EXPECT_FLOAT_EQ(air.At(grid, 2, 0, 2), 0.8F);
}

TEST(AirDensityTest, BetweenTheMiddlesOfBlocksItIsLinear) {
  const RegularGrid grid{{64, 64, 1}, {1000.0, 1000.0, 100.0}, {0.0, 0.0, 0.0}};
  AirDensityMeans means(grid);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) means.Add(x, y, 0.0, 100.0, 1.0F + 0.01F * static_cast<float>(x));
  }
  const AirDensity air = means.Means();
  ASSERT_EQ(air.blocks, glm::ivec2(kAirBlocks));
  for (int x = 2; x < 62; ++x) {
    EXPECT_NEAR(air.At(grid, x, 5, 0), 1.0F + 0.01F * static_cast<float>(x), 1e-5F) << x;
  }
}

TEST(AirDensityTest, BelowAMountainItIsThatOfTheLowestAir) {
  const RegularGrid grid{{1, 1, 3}, {1000.0, 1000.0, 100.0}, {0.0, 0.0, 0.0}};
  AirDensityMeans means(grid);
  EXPECT_TRUE(means.Means().Empty());
  means.Add(0, 0, 100.0, 200.0, 0.9F);
  const AirDensity air = means.Means();
  EXPECT_THAT(air.kg_per_m3, ElementsAre(0.9F, 0.9F, 0.9F));
}

}  // namespace
}  // namespace thunderhead::volume
