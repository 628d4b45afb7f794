#include "volume/drawn_medium.h"

#include <cmath>

#include "gtest/gtest.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::volume {
namespace {

// A place has the noise that was upwind of it.
TEST(DrawnMedium, DetailMovesWithTheWind) {
  HydrometeorFields fields;
  fields.grid.cells = glm::ivec3(24, 24, 8);
  fields.grid.spacing_m = glm::dvec3(500.0, 500.0, 200.0);
  fields.condensate = {glm::ivec3(0), fields.grid.cells};
  fields.fields.resize(1);
  fields.fields[0].concentration_kg_per_m3.assign(fields.grid.CellCount(), 1e-3F);
  const ExtinctionVolume volume = ComputeExtinction(fields, {{0, 100.0F, 0, false}}, 1);
  // At the surface of billows, everywhere.
  const DetailControl control(volume.grid.CellCount(), {.profile = 128, .amplitude = 255});
  const physics::DetailTile tile = physics::MakeDetailTile(4, 1);
  PlacedDetail detail;
  detail.layers = {{&tile, 12e3, {1.0F}}};
  detail.warp_m = glm::dvec3(200.0, 200.0, 100.0);
  const DrawnMedium still(control, detail, volume);
  detail.layers[0].drift_m = {1000.0, -500.0};
  const DrawnMedium drifted(control, detail, volume);
  int differ = 0;
  for (int x = 3; x < 18; ++x) {
    for (int z = 1; z < 7; ++z) {
      const glm::vec3 place = glm::vec3(x, 0.5F * static_cast<float>(x) + 5.0F, z) + 0.25F;
      const float before = still.At(place)[0];
      EXPECT_NEAR(drifted.At(place + glm::vec3(2.0F, -1.0F, 0.0F))[0], before,
                  1e-3F * (before + 1.0F));
      if (std::abs(drifted.At(place)[0] - before) > 0.05F * before) ++differ;
    }
  }
  EXPECT_GT(differ, 20);
}

}  // namespace
}  // namespace thunderhead::volume
