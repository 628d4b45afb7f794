// Tests of reducing a storm's grid to fewer, larger cells.
#include "volume/coarsen.h"

#include <numeric>

#include "gtest/gtest.h"

namespace thunderhead::volume {
namespace {

HydrometeorFields Ramp(const glm::ivec3& cells) {
  HydrometeorFields fields;
  fields.grid = {cells, glm::dvec3(10.0, 20.0, 30.0), glm::dvec3(-50.0, 0.0, 5.0)};
  fields.condensate = {glm::ivec3(0), cells};
  HydrometeorField field;
  field.concentration_kg_per_m3.resize(fields.grid.CellCount());
  std::iota(field.concentration_kg_per_m3.begin(), field.concentration_kg_per_m3.end(), 1.0F);
  fields.fields.push_back(field);
  fields.fields.emplace_back();  // a field that is zero everywhere
  return fields;
}

double Mass_kg(const HydrometeorFields& fields) {
  const std::vector<float>& values = fields.fields[0].concentration_kg_per_m3;
  const glm::dvec3& cell_m = fields.grid.spacing_m;
  return std::accumulate(values.begin(), values.end(), 0.0) * cell_m.x * cell_m.y * cell_m.z;
}

TEST(Coarsened, KeepsMassAndPlace) {
  const HydrometeorFields fine = Ramp({7, 4, 5});
  const HydrometeorFields coarse = Coarsened(fine, {3, 2, 1});
  EXPECT_EQ(coarse.grid.cells, glm::ivec3(3, 2, 5));
  EXPECT_EQ(coarse.grid.spacing_m, glm::dvec3(30.0, 40.0, 30.0));
  EXPECT_EQ(coarse.grid.low_corner_m, fine.grid.low_corner_m);
  EXPECT_EQ(coarse.condensate, (CellBox{glm::ivec3(0), glm::ivec3(3, 2, 5)}));
  EXPECT_NEAR(Mass_kg(coarse) / Mass_kg(fine), 1.0, 1e-6);
  // The coarse cell covers the cells with x 0 to 2 and y 0 to 1, with values 1, 2, 3 and 8, 9, 10.
  EXPECT_NEAR(coarse.fields[0].concentration_kg_per_m3[0], 5.5F, 1e-5F);
  EXPECT_TRUE(coarse.fields[1].concentration_kg_per_m3.empty());
}

TEST(Coarsened, KeepsTheExtinctionOfCellsOfDifferentSizes) {
  HydrometeorFields fine = Ramp({8, 4, 5});
  HydrometeorField& field = fine.fields[0];
  std::vector<float> per_radius = field.concentration_kg_per_m3;
  for (std::size_t i = 0; i < per_radius.size(); ++i) {
    per_radius[i] /= 1e-6F * static_cast<float>(1 + i % 11);
  }
  field.sizes = SizesOf({SizeOrigin::kEffectiveRadius, "RE_CLOUD"}, field.concentration_kg_per_m3,
                        per_radius);
  const HydrometeorFields coarse = Coarsened(fine, {4, 2, 1});
  const auto mean = [](const HydrometeorFields& fields) {
    float sum = 0.0F;
    // Adds all cells into one sum.
    AddExtinction(fields.fields[0], {150.0F, true}, 0, fields.grid.CellCount(), &sum, 0);
    return sum / static_cast<float>(fields.grid.CellCount());
  };
  // Both means use extinction in half floats, with an error of 2^-12 each.
  EXPECT_NEAR(mean(coarse) / mean(fine), 1.0F, 6e-4F);
  EXPECT_EQ(coarse.fields[0].sizes.origin, SizeOrigin::kEffectiveRadius);
  EXPECT_EQ(coarse.fields[0].sizes.name, "RE_CLOUD");
}

TEST(Coarsened, OnlyAsMuchAsIsNeeded) {
  HydrometeorFields fields = Ramp({40, 10, 3});
  EXPECT_EQ(CoarseningFor(fields, 40), glm::ivec3(1));
  EXPECT_EQ(CoarseningFor(fields, 39), glm::ivec3(2, 1, 1));
  EXPECT_EQ(CoarseningFor(fields, 14), glm::ivec3(4, 1, 1));
  // Only cells with condensate have to be stored.
  fields.condensate = {glm::ivec3(5, 0, 0), glm::ivec3(15, 10, 3)};
  EXPECT_EQ(CoarseningFor(fields, 14), glm::ivec3(1));
  fields.condensate = {};
  EXPECT_EQ(CoarseningFor(fields, 14), glm::ivec3(1));
}

}  // namespace
}  // namespace thunderhead::volume
