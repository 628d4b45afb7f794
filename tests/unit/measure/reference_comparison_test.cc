#include "measure/reference_comparison.h"

#include <algorithm>

#include "gtest/gtest.h"
#include "reference/near_sun.h"
#include "reference/scene_problem.h"
#include "tests/support/slab.h"

namespace thunderhead::measure {
namespace {

constexpr double kPeakCut_deg = 3.0;

scene::Scene Towards(double azimuth_deg, double focal_length_mm) {
  scene::Scene scene;
  scene.camera = scene::SpotterCamera{.place_m = {0.0, 2e4},
                                      .eye_height_m = 2.0,
                                      .azimuth_deg = azimuth_deg,
                                      .elevation_deg = 8.0,
                                      .focal_length_mm = focal_length_mm};
  scene.output = {32, 24, 88};
  scene.sun = {255.0, 8.0};
  return scene;
}

picture::LinearPicture Even(float radiance) {
  return {{32, 24},
          std::vector<glm::vec3>(768, glm::vec3(radiance)),
          std::vector<glm::vec3>(768, glm::vec3(0.0F))};
}

TEST(ReferenceComparison, WhatIsNextToTheSunDoesNotCount) {
  const auto fields = support::MakeSlab(8000.0, 6000.0, 0.02);
  const scene::Scene scene = Towards(255.0, 35.0);
  const auto comparison = ReferenceComparison::Of(scene, *fields, Even(2.0F), kPeakCut_deg);
  ASSERT_TRUE(comparison.ok()) << comparison.status();
  picture::LinearPicture drawn = Even(2.5F);
  const std::vector<bool> near_sun =
      reference::NearSun(reference::CameraOf(scene, *fields),
                         scene::Direction(scene.sun.azimuth_deg, scene.sun.elevation_deg),
                         drawn.size_px, kPeakCut_deg);
  ASSERT_GT(std::ranges::count(near_sun, true), 5);
  for (std::size_t i = 0; i < near_sun.size(); ++i) {
    if (near_sun[i]) drawn.radiance[i] = glm::vec3(1e4F);
  }
  EXPECT_NEAR(comparison->RelativeRmseWithoutNoise(drawn), 0.25, 1e-6);
  EXPECT_NEAR(comparison->RelativeBias(drawn), 0.25, 1e-6);
  EXPECT_EQ(comparison->Noise(), 0.0);
}

TEST(ReferenceComparison, AwayFromTheSunAllCounts) {
  const auto fields = support::MakeSlab(8000.0, 6000.0, 0.02);
  picture::LinearPicture noisy = Even(2.0F);
  std::ranges::fill(noisy.standard_error, glm::vec3(0.5F));
  const auto comparison =
      ReferenceComparison::Of(Towards(100.0, 35.0), *fields, noisy, kPeakCut_deg);
  ASSERT_TRUE(comparison.ok()) << comparison.status();
  EXPECT_NEAR(comparison->Noise(), 0.25, 1e-6);
  picture::LinearPicture drawn = Even(2.0F);
  drawn.radiance[0] += 1.0F;
  EXPECT_NEAR(comparison->RelativeBias(drawn), 0.5 / 768.0, 1e-9);
}

TEST(ReferenceComparison, APictureOfTheSunAloneIsRefused) {
  const auto fields = support::MakeSlab(8000.0, 6000.0, 0.02);
  const auto comparison =
      ReferenceComparison::Of(Towards(255.0, 1000.0), *fields, Even(2.0F), kPeakCut_deg);
  EXPECT_TRUE(absl::IsInvalidArgument(comparison.status())) << comparison.status();
  EXPECT_TRUE(ReferenceComparison::Of(Towards(255.0, 1000.0), *fields, Even(2.0F), 0.0).ok());
}

}  // namespace
}  // namespace thunderhead::measure
