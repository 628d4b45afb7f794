#include "reference/near_sun.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "glm/trigonometric.hpp"
#include "gtest/gtest.h"

namespace thunderhead::reference {
namespace {

// Returns a camera whose view is 20 degrees wide and high.
Camera LooksAlong(const glm::dvec3& forward) {
  const double half = std::tan(glm::radians(10.0));
  Camera camera;
  camera.forward = forward;
  camera.right = half * glm::normalize(glm::cross(forward, glm::dvec3(0.0, 0.0, 1.0)));
  camera.up = half * glm::normalize(glm::cross(camera.right, forward));
  return camera;
}

TEST(NearSun, IsADiscAroundTheSunAsLargeAsTheCut) {
  const glm::dvec3 sun = glm::normalize(glm::dvec3(0.3, 0.8, 0.2));
  const std::vector<bool> near = NearSun(LooksAlong(sun), sun, {400, 400}, 3.0);
  const double radius_px = 200.0 * std::tan(glm::radians(3.0)) / std::tan(glm::radians(10.0));
  EXPECT_NEAR(static_cast<double>(std::ranges::count(near, true)),
              std::numbers::pi * radius_px * radius_px, 0.05 * 400.0 * 400.0 / 10.0);
  EXPECT_TRUE(near[200 * 400 + 200]);
  EXPECT_FALSE(near[0]);
}

TEST(NearSun, RowsBeginAtTheTop) {
  const glm::dvec3 forward(0.0, 1.0, 0.0);
  const double above_rad = glm::radians(8.0);
  const glm::dvec3 sun(0.0, std::cos(above_rad), std::sin(above_rad));
  const std::vector<bool> near = NearSun(LooksAlong(forward), sun, {100, 100}, 1.0);
  EXPECT_TRUE(near[10 * 100 + 50]);
  EXPECT_FALSE(near[90 * 100 + 50]);
}

TEST(NearSun, WithoutACutItIsTheDiscAlone) {
  const glm::dvec3 sun = glm::normalize(glm::dvec3(0.3, 0.8, 0.2));
  const std::vector<bool> near = NearSun(LooksAlong(sun), sun, {401, 401}, 0.0);
  // The radius is 0.27 degrees and half a pixel's diagonal: 5.3 + 0.7 pixels.
  EXPECT_NEAR(static_cast<double>(std::ranges::count(near, true)), std::numbers::pi * 6.0 * 6.0,
              20.0);
}

TEST(NearSun, NothingIsNearASunBehindTheViewer) {
  const glm::dvec3 sun = glm::normalize(glm::dvec3(0.3, 0.8, 0.2));
  const std::vector<bool> near = NearSun(LooksAlong(-sun), sun, {40, 40}, 3.0);
  EXPECT_EQ(std::ranges::count(near, true), 0);
}

}  // namespace
}  // namespace thunderhead::reference
