#include "scene/place_seen.h"

#include <cmath>

#include "glm/geometric.hpp"
#include "gtest/gtest.h"
#include "scene/view.h"

namespace thunderhead::scene {
namespace {

constexpr double kCell_m = 100.0;

// A slab of cloud of this extinction between 2000 and 3000 m over flat ground, in a domain of 40 km
// x 40 km x 5 km. The camera looks from above, for which the world is treated as flat.
struct Slab {
  explicit Slab(double extinction_per_m) {
    fields.grid = {{40, 40, 50}, {1000.0, 1000.0, kCell_m}, {-20000.0, -20000.0, 0.0}};
    volume::HydrometeorField cloud;
    cloud.quantity = volume::Quantity::kExtinction;
    cloud.concentration_kg_per_m3.assign(fields.grid.CellCount(), 0.0F);
    for (int z = 20; z < 30; ++z) {
      const std::size_t layer = fields.grid.Offset(0, 0, z);
      for (std::size_t i = 0; i < 1600; ++i) {
        cloud.concentration_kg_per_m3[layer + i] = static_cast<float>(extinction_per_m);
      }
    }
    cloud.statistics.maximum = static_cast<float>(extinction_per_m);
    fields.fields.push_back(cloud);
    fields.terrain_height_m.assign(1600, 0.0F);
    fields.condensate = {{0, 0, 20}, {40, 40, 30}};
    scene.camera = TopDownCamera();
  }

  glm::dvec3 Seen(const glm::dvec3& origin_m, const glm::dvec3& direction) const {
    return PlaceSeen(scene, fields, origin_m, glm::normalize(direction));
  }

  volume::HydrometeorFields fields;
  Scene scene;
};

TEST(PlaceSeen, DenseCloudIsMetWhereHalfOfItsLightIsBehind) {
  const Slab slab(0.01);
  const glm::dvec3 seen = slab.Seen({50.0, 50.0, 20000.0}, {0.0, 0.0, -1.0});
  EXPECT_NEAR(seen.z, 3000.0 - std::log(2.0) / 0.01, kCell_m / 2.0);
  EXPECT_DOUBLE_EQ(seen.x, 50.0);
}

TEST(PlaceSeen, ThinCloudIsMetInItsMiddle) {
  const Slab slab(0.0002);
  const glm::dvec3 seen = slab.Seen({50.0, 50.0, 20000.0}, {0.0, 0.0, -1.0});
  EXPECT_NEAR(seen.z, 2500.0, kCell_m);
}

TEST(PlaceSeen, HardlyAnyCloudShowsTheGround) {
  const Slab slab(0.00005);
  const glm::dvec3 seen = slab.Seen({50.0, 50.0, 20000.0}, {0.1, 0.0, -1.0});
  EXPECT_NEAR(seen.z, 0.0, 2.0);
  EXPECT_NEAR(seen.x, 2050.0, 2.0);
}

TEST(PlaceSeen, GroundBeforeTheCloudHidesIt) {
  Slab slab(0.01);
  slab.fields.terrain_height_m.assign(1600, 3500.0F);
  const glm::dvec3 seen = slab.Seen({50.0, 50.0, 20000.0}, {0.0, 0.0, -1.0});
  EXPECT_NEAR(seen.z, 3500.0, 2.0);
}

TEST(PlaceSeen, ClearSkyHasThePointNearestToTheStorm) {
  const Slab slab(0.01);
  const glm::dvec3 seen = slab.Seen({-50000.0, 0.0, 8000.0}, {1.0, 0.0, 0.0});
  EXPECT_NEAR(seen.x, 0.0, 1.0);
  EXPECT_NEAR(seen.z, 8000.0, 1e-6);
  // If the camera looks away from the storm, the returned place is the camera's position.
  EXPECT_NEAR(slab.Seen({-50000.0, 0.0, 8000.0}, {-1.0, 0.0, 0.0}).x, -50000.0, 1e-6);
}

TEST(PlaceSeen, FromInsideTheCloudItIsWithinHalfACell) {
  const Slab slab(0.05);
  const glm::dvec3 origin_m(0.0, 0.0, 2500.0);
  EXPECT_LE(glm::distance(slab.Seen(origin_m, {1.0, 0.0, 0.0}), origin_m), 500.0);
  EXPECT_LE(glm::distance(slab.Seen(origin_m, {0.0, 0.0, -1.0}), origin_m), kCell_m / 2.0);
}

}  // namespace
}  // namespace thunderhead::scene
