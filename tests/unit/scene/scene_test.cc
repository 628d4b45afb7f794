#include "scene/scene.h"

#include <cmath>

#include "glm/geometric.hpp"
#include "gtest/gtest.h"
#include "scene/view.h"

namespace thunderhead::scene {
namespace {

Stage After(void (*change)(Scene*)) {
  const Scene before;
  Scene after;
  change(&after);
  return FirstDirtyStage(before, after);
}

TEST(Scene, EachChangeRerunsFromItsOwnStage) {
  EXPECT_EQ(After([](Scene*) {}), Stage::kNothing);
  EXPECT_EQ(After([](Scene* s) { s->time_index = 1; }), Stage::kStorm);
  EXPECT_EQ(After([](Scene* s) { s->storm_id = "b"; }), Stage::kStorm);
  EXPECT_EQ(After([](Scene* s) { s->fields[0].scale = 2; }), Stage::kExtinction);
  EXPECT_EQ(After([](Scene* s) { s->fields[2].visible = false; }), Stage::kExtinction);
  EXPECT_EQ(After([](Scene* s) { s->rendering.false_colors = true; }), Stage::kExtinction);
  EXPECT_EQ(After([](Scene* s) { s->sun.azimuth_deg = 10; }), Stage::kLight);
  EXPECT_EQ(After([](Scene* s) { s->rendering.slices = 64; }), Stage::kLight);
  EXPECT_EQ(After([](Scene* s) { s->camera.azimuth_deg = 10; }), Stage::kView);
  EXPECT_EQ(After([](Scene* s) { s->output.width_px = 10; }), Stage::kView);
  EXPECT_EQ(After([](Scene* s) { s->display.exposure_ev = 1; }), Stage::kTone);
}

TEST(View, AzimuthsAreClockwiseFromNorth) {
  EXPECT_NEAR(Direction(0, 0).y, 1.0, 1e-12);
  EXPECT_NEAR(Direction(90, 0).x, 1.0, 1e-12);
  EXPECT_NEAR(Direction(123, 90).z, 1.0, 1e-12);
}

TEST(View, CameraStandsWhereItsAzimuthSays) {
  OrbitCamera camera;
  camera.azimuth_deg = 180;  // south of the target, looking north
  camera.elevation_deg = 0;
  camera.distance_m = 1000;
  camera.field_of_view_deg = 90;
  const View view = ViewOf(camera, 2.0);
  EXPECT_NEAR(view.eye_m.y, -1000, 1e-9);
  EXPECT_NEAR(view.forward.y, 1.0, 1e-12);
  EXPECT_NEAR(view.right.x, 1.0, 1e-12);
  EXPECT_NEAR(view.up.z, 1.0, 1e-12);
  EXPECT_NEAR(view.tan_half_height, 1.0, 1e-12);
  EXPECT_NEAR(view.tan_half_width, 2.0, 1e-12);
}

TEST(View, FramingShowsEveryCornerOfTheBox) {
  const glm::dvec3 low(-50e3, -20e3, 0);
  const glm::dvec3 high(60e3, 30e3, 15e3);
  for (double aspect : {0.5, 1.0, 2.0}) {
    for (double azimuth_deg : {0.0, 77.0, 200.0}) {
      OrbitCamera camera;
      camera.azimuth_deg = azimuth_deg;
      camera.elevation_deg = 20;
      const View view = ViewOf(Framing(camera, low, high, aspect), aspect);
      double fullest = 0.0;
      for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 point((corner & 1) ? high.x : low.x, (corner & 2) ? high.y : low.y,
                               (corner & 4) ? high.z : low.z);
        const glm::dvec3 offset = point - view.eye_m;
        const double depth = glm::dot(offset, view.forward);
        ASSERT_GT(depth, 0.0);
        fullest =
            std::max({fullest, std::abs(glm::dot(offset, view.right)) / depth / view.tan_half_width,
                      std::abs(glm::dot(offset, view.up)) / depth / view.tan_half_height});
      }
      EXPECT_LE(fullest, 1.0);
      EXPECT_GT(fullest, 0.8) << "the storm should fill the picture";
    }
  }
}

}  // namespace
}  // namespace thunderhead::scene
