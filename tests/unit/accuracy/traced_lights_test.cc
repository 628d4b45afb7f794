#include "accuracy/traced_lights.h"

#include "gtest/gtest.h"

namespace thunderhead::accuracy {
namespace {

TEST(TracedLights, AreSharedByScenesThatLightTheStormAlike) {
  const scene::Scene traced;
  const auto shares = [&](const auto& change) {
    scene::Scene scene = traced;
    change(scene);
    return SharesLight(traced, scene) && SharesLight(scene, traced);
  };
  EXPECT_TRUE(shares([](scene::Scene& scene) { scene.camera = scene::SpotterCamera(); }));
  EXPECT_TRUE(shares([](scene::Scene& scene) { scene.ground.borders = true; }));
  EXPECT_TRUE(shares([](scene::Scene& scene) { scene.ground.rings = true; }));
  EXPECT_TRUE(shares([](scene::Scene& scene) { scene.lights.emplace_back(); }));
  EXPECT_TRUE(shares([](scene::Scene& scene) { scene.display.exposure_ev = 1.0; }));
  EXPECT_TRUE(shares([](scene::Scene& scene) { scene.output.width_px = 10; }));
  EXPECT_TRUE(shares([](scene::Scene& scene) { scene.accuracy = scene::MaxError{0.1}; }));
  EXPECT_TRUE(shares([](scene::Scene& scene) { scene.rendering.image_scale = 0.5; }));
  EXPECT_TRUE(shares([](scene::Scene& scene) {
    scene::SetTracedLight(&scene.rendering.technique, scene::TracedLight::kAwaited);
  }));
  EXPECT_FALSE(shares([](scene::Scene& scene) {
    scene::MediumSettingsOf(&scene.rendering.technique)->look.detail = false;
  }));
  EXPECT_FALSE(shares([](scene::Scene& scene) { scene.fields[0].detail.share = 0.5F; }));
  EXPECT_FALSE(shares([](scene::Scene& scene) { scene.rendering.technique = scene::HalfAngle(); }));
  EXPECT_FALSE(
      shares([](scene::Scene& scene) { scene.ground.cover = scene::GroundCover::kFields; }));
  EXPECT_FALSE(shares([](scene::Scene& scene) { scene.sky.turbidity = 3.0; }));
  EXPECT_FALSE(shares([](scene::Scene& scene) { scene.sun.azimuth_deg = 3.0; }));
}

}  // namespace
}  // namespace thunderhead::accuracy
