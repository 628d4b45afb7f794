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
  EXPECT_FALSE(
      shares([](scene::Scene& scene) { scene.ground.cover = scene::GroundCover::kFields; }));
  EXPECT_FALSE(shares([](scene::Scene& scene) { scene.sky.turbidity = 3.0; }));
  EXPECT_FALSE(shares([](scene::Scene& scene) { scene.sun.azimuth_deg = 3.0; }));
}

}  // namespace
}  // namespace thunderhead::accuracy
