#include "accuracy/probe_cameras.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "glm/geometric.hpp"
#include "gtest/gtest.h"
#include "scene/view.h"

namespace thunderhead::accuracy {
namespace {

constexpr int kMany = 256;
const volume::WorldBox kBox{{-2e4, -1e4, 0.0}, {4e4, 3e4, 1.5e4}};
constexpr glm::dvec2 kMiddle_m{1e4, 1e4};

TEST(ProbeCameras, AroundTheStormAllSidesAreSeenAlike) {
  glm::dvec3 sum(0.0);
  double lowest_deg = 90.0;
  double highest_deg = 0.0;
  for (int i = 0; i < kMany; ++i) {
    const auto camera =
        std::get<scene::OrbitCamera>(AroundStorm(kBox, 1.5, static_cast<std::uint64_t>(i)));
    EXPECT_EQ(glm::dvec2(camera.target_m), kMiddle_m);
    EXPECT_GT(camera.distance_m, 3e4);  // the camera is outside the storm
    lowest_deg = std::min(lowest_deg, camera.elevation_deg);
    highest_deg = std::max(highest_deg, camera.elevation_deg);
    sum += scene::Direction(camera.azimuth_deg, camera.elevation_deg);
  }
  // The expected values are means over directions distributed evenly over the upper hemisphere.
  EXPECT_NEAR(sum.x / kMany, 0.0, 0.02);
  EXPECT_NEAR(sum.y / kMany, 0.0, 0.02);
  EXPECT_NEAR(sum.z / kMany, 0.5, 0.02);
  EXPECT_GE(lowest_deg, 0.0);
  EXPECT_LT(lowest_deg, 2.0);
  EXPECT_GT(highest_deg, 80.0);
}

TEST(ProbeCameras, NudgedOrbitsStayNear) {
  scene::OrbitCamera camera;
  camera.elevation_deg = 88.0;
  for (int i = 0; i < kMany; ++i) {
    const auto nudged =
        std::get<scene::OrbitCamera>(Nudged(camera, kBox, static_cast<std::uint64_t>(i)));
    EXPECT_EQ(nudged.target_m, camera.target_m);
    EXPECT_LE(std::abs(nudged.azimuth_deg - camera.azimuth_deg), 10.0);
    EXPECT_LE(std::abs(nudged.elevation_deg - camera.elevation_deg), 3.0);
    EXPECT_LE(nudged.elevation_deg, 89.0);
    EXPECT_NEAR(nudged.distance_m / camera.distance_m, 1.0, 0.05);
  }
}

TEST(ProbeCameras, NudgedSpottersKeepTheStormWhereItIsInThePicture) {
  scene::SpotterCamera camera;
  camera.place_m = kMiddle_m + glm::dvec2(-3e4, -7e4);
  camera.azimuth_deg = 31.0;
  const auto bearing_deg = [](const scene::SpotterCamera& spotter) {
    const glm::dvec2 towards_m = kMiddle_m - spotter.place_m;
    const double turn =
        std::atan2(towards_m.x, towards_m.y) * 57.29577951308232 - spotter.azimuth_deg;
    return std::remainder(turn, 360.0);
  };
  const double distance_m = glm::distance(camera.place_m, kMiddle_m);
  double farthest_m = 0.0;
  for (int i = 0; i < kMany; ++i) {
    const auto nudged =
        std::get<scene::SpotterCamera>(Nudged(camera, kBox, static_cast<std::uint64_t>(i)));
    EXPECT_NEAR(bearing_deg(nudged), bearing_deg(camera), 1e-9);
    EXPECT_NEAR(glm::distance(nudged.place_m, kMiddle_m) / distance_m, 1.0, 0.05 + 1e-9);
    EXPECT_EQ(nudged.elevation_deg, camera.elevation_deg);
    farthest_m = std::max(farthest_m, glm::distance(nudged.place_m, camera.place_m));
  }
  EXPECT_GT(farthest_m, 0.1 * distance_m);
}

TEST(ProbeCameras, NudgedTopDownViewsOnlyChangeTheirWidth) {
  scene::TopDownCamera camera;
  camera.center_m = {100.0, 200.0};
  const auto nudged = std::get<scene::TopDownCamera>(Nudged(camera, kBox, 5));
  EXPECT_EQ(nudged.center_m, camera.center_m);
  EXPECT_NE(nudged.width_m, camera.width_m);
  EXPECT_NEAR(nudged.width_m / camera.width_m, 1.0, 0.05);
}

}  // namespace
}  // namespace thunderhead::accuracy
