// Tests of the parts of the light that can be left out of a reference picture.
#include "reference/trace_scene.h"

#include <cmath>

#include "comparisons.h"
#include "gtest/gtest.h"
#include "tests/support/techniques.h"

namespace thunderhead::reference {
namespace {

// Returns a thin cube of cloud in the middle of the picture.
volume::HydrometeorFields ThinCloud() {
  volume::HydrometeorFields fields;
  fields.grid = {{5, 5, 5}, {200.0, 200.0, 200.0}, {-500.0, -500.0, 1000.0}};
  volume::HydrometeorField cloud;
  cloud.concentration_kg_per_m3.assign(fields.grid.CellCount(), 0.0F);
  for (int z = 1; z < 4; ++z) {
    for (int y = 1; y < 4; ++y) {
      for (int x = 1; x < 4; ++x) {
        cloud.concentration_kg_per_m3[fields.grid.Offset(x, y, z)] = 1e-5F;
      }
    }
  }
  fields.fields = {cloud};
  fields.condensate = {glm::ivec3(1), glm::ivec3(4)};
  return fields;
}

scene::Scene SceneOfCloud() {
  scene::Scene scene = test_support::PlainScene();
  scene.camera = scene::OrbitCamera{
      .target_m = {0.0, 0.0, 1500.0}, .azimuth_deg = 200.0, .distance_m = 4000.0};
  scene.output = {16, 16, 88};
  scene.sky.ground_albedo = 0.0;
  scene.sun.elevation_deg = 20.0;
  // Replaces the droplets' phase function, whose diffraction peak is noisy.
  scene.fields[physics::IndexOf(physics::Hydrometeor::kCloud)].optics.phase = {
      physics::PhaseKind::kHenyeyGreenstein, 0.5F};
  return scene;
}

FluxShare SceneMeanOf(const scene::Scene& scene, const TraceOptions& options) {
  RefineLimits limits;
  limits.samples_per_pixel = 1000;
  const auto traced = TraceScene(scene, ThinCloud(), options, limits, {}, {});
  EXPECT_TRUE(traced.ok());
  FluxShare mean;
  const auto pixels = static_cast<double>(traced->image.radiance.size());
  for (std::size_t i = 0; i < traced->image.radiance.size(); ++i) {
    mean.value += static_cast<double>(traced->image.radiance[i].z) / pixels;
    const double error = static_cast<double>(traced->image.standard_error[i].z) / pixels;
    mean.standard_error += error * error;
  }
  mean.standard_error = std::sqrt(mean.standard_error);
  return mean;
}

TEST(TraceSceneTest, WithoutAirTheSunIsThatAboveTheAtmosphere) {
  scene::Scene scene = SceneOfCloud();
  scene.sky.turbidity = 8.0;
  scene.sun.irradiance = 2.0;
  const FluxShare traced = SceneMeanOf(scene, {.peak_cut_deg = 0.0, .air = false});
  // Light from the scene's own lights does not pass through air.
  scene.lights = {{.azimuth_deg = scene.sun.azimuth_deg,
                   .elevation_deg = scene.sun.elevation_deg,
                   .irradiance = scene.sun.irradiance}};
  scene.sun.irradiance = 0.0;
  const FluxShare expected = SceneMeanOf(scene, {.peak_cut_deg = 0.0, .air = false});
  EXPECT_GT(expected.value, 0.0);
  FluxShare difference = traced;
  difference.standard_error = std::hypot(traced.standard_error, expected.standard_error);
  // Air of this turbidity would transmit only a fifth of a low sun's blue, far less than the
  // tolerance permits.
  ExpectAgrees(difference, expected.value, 0.0, 0.05 * expected.value);
}

TEST(TraceSceneTest, WithoutAirAndSunAllIsBlack) {
  EXPECT_GT(SceneMeanOf(SceneOfCloud(), {.sun = false}).value, 0.0) << "the sky";
  EXPECT_EQ(SceneMeanOf(SceneOfCloud(), {.sun = false, .air = false}).value, 0.0);
}

}  // namespace
}  // namespace thunderhead::reference
