#include "volume/extinction.h"

#include <cmath>
#include <cstring>

#include "glm/gtc/packing.hpp"
#include "gtest/gtest.h"

namespace thunderhead::volume {
namespace {

HydrometeorFields TwoFields() {
  HydrometeorFields fields;
  fields.grid = {{8, 6, 4}, {100.0, 100.0, 50.0}, {-400.0, -300.0, 0.0}};
  fields.condensate = {{0, 0, 0}, fields.grid.cells};
  for (const auto hydrometeor : {physics::Hydrometeor::kCloud, physics::Hydrometeor::kSnow}) {
    HydrometeorField field;
    field.hydrometeor = hydrometeor;
    field.concentration_kg_per_m3.assign(fields.grid.CellCount(), 0.0F);
    fields.fields.push_back(field);
  }
  return fields;
}

float TexelPerM(const ExtinctionVolume& volume, int x, int y, int z, int channel) {
  const ExtinctionPlane& plane = volume.planes[static_cast<std::size_t>(channel / 4)];
  const std::size_t offset =
      volume.grid.Offset(x, y, z) * static_cast<std::size_t>(plane.channels) +
      static_cast<std::size_t>(channel % 4);
  return glm::unpackHalf1x16(plane.texels[offset]) * volume.extinction_per_m;
}

TEST(Extinction, AddsFieldsIntoTheirChannels) {
  HydrometeorFields fields = TwoFields();
  fields.fields[0].concentration_kg_per_m3[fields.grid.Offset(3, 2, 1)] = 1e-3F;
  fields.fields[1].concentration_kg_per_m3[fields.grid.Offset(3, 2, 1)] = 4e-3F;
  fields.fields[1].concentration_kg_per_m3[fields.grid.Offset(4, 2, 1)] = 1e-3F;
  const ExtinctionVolume apart = ComputeExtinction(fields, {{0, 150.0F, 0}, {1, 7.5F, 1}}, 2);
  // The occupied cells are x 3..4, y 2, z 1, with one empty cell around them.
  EXPECT_EQ(apart.grid.cells, glm::ivec3(4, 3, 3));
  EXPECT_EQ(apart.grid.low_corner_m, glm::dvec3(-200.0, -200.0, 0.0));
  EXPECT_NEAR(TexelPerM(apart, 1, 1, 1, 0), 0.15F, 1e-4F);
  EXPECT_NEAR(TexelPerM(apart, 1, 1, 1, 1), 0.03F, 2e-5F);
  EXPECT_NEAR(TexelPerM(apart, 2, 1, 1, 1), 0.0075F, 5e-6F);
  EXPECT_EQ(TexelPerM(apart, 0, 1, 1, 0), 0.0F);
  EXPECT_NEAR(apart.maximum_per_m, 0.18F, 1e-6F);
  const ExtinctionVolume merged = ComputeExtinction(fields, {{0, 150.0F, 0}, {1, 7.5F, 0}}, 1);
  EXPECT_NEAR(TexelPerM(merged, 1, 1, 1, 0), 0.18F, 1e-4F);
}

TEST(Extinction, EmptyFieldsHaveNoVolume) {
  HydrometeorFields fields = TwoFields();
  EXPECT_TRUE(ComputeExtinction(fields, {{0, 150.0F, 0}}, 1).Empty());
  fields.fields[0].concentration_kg_per_m3.clear();
  EXPECT_TRUE(ComputeExtinction(fields, {{0, 150.0F, 0}}, 1).Empty());
  EXPECT_TRUE(ComputeExtinction(fields, {}, 0).Empty());
}

TEST(Extinction, LeavesOutWhatAddsUpToNothing) {
  HydrometeorFields fields = TwoFields();
  fields.fields[0].concentration_kg_per_m3.assign(fields.grid.CellCount(), 1e-12F);
  fields.fields[0].concentration_kg_per_m3[fields.grid.Offset(5, 5, 3)] = 1e-3F;
  const ExtinctionVolume volume = ComputeExtinction(fields, {{0, 150.0F, 0}}, 1);
  EXPECT_EQ(volume.grid.cells, glm::ivec3(3, 2, 2))
      << "the domain's corner needs no border outside";
}

TEST(Extinction, AThinMediumIsHeldInProportionToItsThickestCell) {
  // The domain's diagonal is 1020 m. The whole storm is so thin that such extinction would be left
  // out at the edge of a thick medium.
  for (const float thickest : {1e-9F, 1e-11F}) {
    HydrometeorFields fields = TwoFields();
    std::vector<float>& concentration = fields.fields[0].concentration_kg_per_m3;
    concentration.assign(fields.grid.CellCount(), 1e-4F * thickest);
    concentration[fields.grid.Offset(3, 2, 1)] = thickest;
    concentration[fields.grid.Offset(4, 2, 1)] = 2e-3F * thickest;
    const ExtinctionVolume volume = ComputeExtinction(fields, {{0, 150.0F, 0}}, 1);
    ASSERT_EQ(volume.grid.cells, glm::ivec3(4, 3, 3)) << "two cells with one around";
    EXPECT_NEAR(TexelPerM(volume, 1, 1, 1, 0) / (150.0F * thickest), 1.0F, 5e-4F);
  }
  HydrometeorFields fields = TwoFields();
  fields.fields[0].concentration_kg_per_m3[fields.grid.Offset(3, 2, 1)] = 5e-15F;
  EXPECT_TRUE(ComputeExtinction(fields, {{0, 150.0F, 0}}, 1).Empty()) << "not even that";
}

TEST(Extinction, TheBoxEndsWhereLinearFilteringDoes) {
  HydrometeorFields fields = TwoFields();
  fields.fields[0].concentration_kg_per_m3[fields.grid.Offset(3, 2, 0)] = 1e-3F;
  const ExtinctionVolume volume = ComputeExtinction(fields, {{0, 150.0F, 0}}, 1);
  // The box ends inside the domain at the middle of the border cell, and at the ground at the
  // domain's face.
  EXPECT_EQ(volume.low_m, glm::dvec3(-150.0, -150.0, 0.0));
  EXPECT_EQ(volume.high_m, glm::dvec3(50.0, 50.0, 75.0));
}

TEST(Extinction, SurvivesExtremes) {
  HydrometeorFields fields = TwoFields();
  fields.fields[0].concentration_kg_per_m3[fields.grid.Offset(3, 2, 1)] = 1e-3F;
  for (const float mass_extinction : {1e-6F, 1.0F, 1.5e10F}) {
    const ExtinctionVolume volume = ComputeExtinction(fields, {{0, mass_extinction, 0}}, 1);
    ASSERT_FALSE(volume.Empty()) << mass_extinction;
    EXPECT_NEAR(TexelPerM(volume, 1, 1, 1, 0) / (1e-3F * mass_extinction), 1.0F, 5e-4F);
  }
}

}  // namespace
}  // namespace thunderhead::volume
