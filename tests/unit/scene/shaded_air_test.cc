#include "scene/shaded_air.h"

#include "glm/geometric.hpp"
#include "glm/vector_relational.hpp"
#include "gtest/gtest.h"
#include "scene/view.h"

namespace thunderhead::scene {
namespace {

const volume::WorldBox kStorm{{-10e3, -5e3, 1e3}, {20e3, 15e3, 12e3}};

bool Holds(const volume::WorldBox& box, const glm::dvec3& point_m) {
  return glm::all(glm::greaterThanEqual(point_m, box.low_m - 1e-6)) &&
         glm::all(glm::lessThanEqual(point_m, box.high_m + 1e-6));
}

TEST(ShadedAir, HoldsTheShadowOfEachCornerDownToTheGround) {
  for (const double azimuth_deg : {0.0, 130.0, 255.0}) {
    for (const double elevation_deg : {90.0, 35.0, 12.0}) {
      const glm::dvec3 towards_sun = Direction(azimuth_deg, elevation_deg);
      const ShadedAir air = ShadedAirOf(kStorm, towards_sun, 300.0);
      for (const double x : {kStorm.low_m.x, kStorm.high_m.x}) {
        for (const double y : {kStorm.low_m.y, kStorm.high_m.y}) {
          const glm::dvec3 corner_m(x, y, kStorm.high_m.z);
          EXPECT_TRUE(Holds(air.from_sun, corner_m));
          const double to_ground_m = (corner_m.z - 300.0) / towards_sun.z;
          EXPECT_TRUE(Holds(air.from_sun, corner_m - to_ground_m * towards_sun))
              << azimuth_deg << ' ' << elevation_deg;
          EXPECT_TRUE(Holds(air.from_sky, {x, y, 300.0}));
        }
      }
    }
  }
}

TEST(ShadedAir, IsBoundedForASunOnTheHorizon) {
  const ShadedAir air = ShadedAirOf(kStorm, Direction(90.0, 0.0), 0.0);
  EXPECT_NEAR(air.from_sun.low_m.x, kStorm.low_m.x - 150e3, 1.0);
  EXPECT_EQ(air.from_sun.high_m.x, kStorm.high_m.x);
}

// The ground of the round Earth falls below the world's plane.
TEST(ShadedAir, ReachesTheGroundFarFromTheStorm) {
  EXPECT_LT(ShadedAirOf(kStorm, Direction(0.0, 40.0), 0.0).from_sun.low_m.z, -2000.0);
}

}  // namespace
}  // namespace thunderhead::scene
