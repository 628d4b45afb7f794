#include "volume/visible_box.h"

#include "gtest/gtest.h"

namespace thunderhead::volume {
namespace {

HydrometeorFields EmptyStorm() {
  HydrometeorFields fields;
  fields.grid = {{10, 8, 6}, {100.0, 100.0, 50.0}, {-500.0, -400.0, 0.0}};
  fields.condensate = {{0, 0, 0}, fields.grid.cells};
  fields.fields.resize(1);
  return fields;
}

TEST(VisibleBox, OfAnEmptyStormIsItsDomain) {
  const WorldBox box = VisibleBox(EmptyStorm());
  EXPECT_EQ(box.low_m, glm::dvec3(-500, -400, 0));
  EXPECT_EQ(box.high_m, glm::dvec3(500, 400, 300));
}

TEST(VisibleBox, LeavesTracesOut) {
  HydrometeorFields fields = EmptyStorm();
  fields.fields[0].concentration_kg_per_m3.assign(fields.grid.CellCount(), 1e-9F);
  for (int x = 3; x < 6; ++x) {
    fields.fields[0].concentration_kg_per_m3[fields.grid.Offset(x, 2, 4)] = 1e-3F;
  }
  const WorldBox box = VisibleBox(fields);
  EXPECT_EQ(box.low_m, glm::dvec3(-200, -200, 200));
  EXPECT_EQ(box.high_m, glm::dvec3(100, -100, 250));
}

// Ice with a radius of 30 um is visible at a concentration at which the papers' crystals of 1 mm
// are not.
TEST(VisibleBox, FollowsTheSizesOfTheParticles) {
  HydrometeorFields fields = EmptyStorm();
  fields.fields.resize(2);
  fields.fields[1].hydrometeor = physics::Hydrometeor::kIce;
  for (HydrometeorField& field : fields.fields) {
    field.concentration_kg_per_m3.assign(fields.grid.CellCount(), 0.0F);
  }
  fields.fields[0].concentration_kg_per_m3[fields.grid.Offset(3, 2, 4)] = 1e-3F;
  fields.fields[1].concentration_kg_per_m3[fields.grid.Offset(8, 2, 4)] = 3e-5F;
  EXPECT_EQ(VisibleBox(fields, physics::SizeSource::kModel).high_m, glm::dvec3(400, -100, 250));
  EXPECT_EQ(VisibleBox(fields, physics::SizeSource::kPapers).high_m, glm::dvec3(-100, -100, 250));
}

TEST(VisibleBox, OfAFullDomainIsTheDomain) {
  HydrometeorFields fields = EmptyStorm();
  fields.fields[0].concentration_kg_per_m3.assign(fields.grid.CellCount(), 1e-3F);
  EXPECT_EQ(VisibleBox(fields).low_m, fields.grid.low_corner_m);
  EXPECT_EQ(VisibleBox(fields).high_m, fields.grid.HighCorner_m());
}

}  // namespace
}  // namespace thunderhead::volume
