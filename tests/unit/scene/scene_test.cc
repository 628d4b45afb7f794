#include "scene/scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

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
  EXPECT_EQ(After([](Scene* s) { s->fields[2].sizes = physics::SizeSource::kPapers; }),
            Stage::kExtinction);
  EXPECT_EQ(
      After([](Scene* s) { MediumSettingsOf(&s->rendering.technique)->look.false_colors = true; }),
      Stage::kExtinction);
  EXPECT_EQ(After([](Scene* s) { s->sun.azimuth_deg = 10; }), Stage::kLight);
  EXPECT_EQ(After([](Scene* s) { SetSlices(&s->rendering.technique, 64); }), Stage::kLight);
  EXPECT_EQ(After([](Scene* s) { std::get<OrbitCamera>(s->camera).azimuth_deg = 10; }),
            Stage::kView);
  EXPECT_EQ(After([](Scene* s) { s->camera = SpotterCamera(); }), Stage::kView);
  EXPECT_EQ(After([](Scene* s) { s->output.width_px = 10; }), Stage::kView);
  EXPECT_EQ(After([](Scene* s) { s->display.exposure_ev = 1; }), Stage::kTone);
}

TEST(Scene, ANewSkyLightsTheGroundUnderDiffusion) {
  for (const Transport transport : {Transport::kDiffusion, Transport::kConsistent}) {
    Scene before;
    MediumSettingsOf(&before.rendering.technique)->transport = transport;
    Scene after = before;
    after.sky.turbidity = 9.0;
    EXPECT_EQ(FirstDirtyStage(before, after),
              transport == Transport::kDiffusion ? Stage::kLight : Stage::kView);
  }
}

TEST(Scene, WhatIsPaintedOnTheGroundDoesNotLightTheStorm) {
  EXPECT_EQ(After([](Scene* s) { s->ground.cover = GroundCover::kFields; }), Stage::kLight);
  EXPECT_EQ(After([](Scene* s) { s->ground.borders = true; }), Stage::kView);
  EXPECT_EQ(After([](Scene* s) { s->ground.rings = true; }), Stage::kView);
}

TEST(Scene, EachTechniqueRerunsFromItsOwnStage) {
  const auto first = [](const Technique& before, const Technique& after) {
    Scene a;
    a.rendering.technique = before;
    Scene b = a;
    b.rendering.technique = after;
    return FirstDirtyStage(a, b);
  };
  EXPECT_EQ(first(Cumulus{}, Cumulus{}), Stage::kNothing);
  EXPECT_EQ(first(Cumulus{}, Cumulus{.scales = 4}), Stage::kExtinction);
  EXPECT_EQ(first(Cumulus{}, Cumulus{.corona = 0.9F}), Stage::kLight);
  EXPECT_EQ(first(Cumulus{}, Cumulus{.trap = 0.1F}), Stage::kView);
  EXPECT_EQ(first(Cumulus{}, LightVolume{}), Stage::kExtinction);
  EXPECT_EQ(first(LightVolume{}, Cumulus{}), Stage::kExtinction);
  EXPECT_EQ(first(LightVolume{}, LightVolume{.traced_light = TracedLight::kOff}), Stage::kView);
  EXPECT_EQ(first(HalfAngle{}, HalfAngle{.slices = 7}), Stage::kLight);
  EXPECT_EQ(first(Metaballs{}, Metaballs{.count = 7}), Stage::kLight);
  EXPECT_EQ(first(Reference{}, Reference{.false_colors = true}), Stage::kExtinction);
  EXPECT_EQ(first(OtherTechnique{"a", {}}, OtherTechnique{"b", {}}), Stage::kExtinction);
  // Techniques that draw a medium share the uploaded medium, if they show the same properties of
  // its fields.
  const HalfAngle detailed{
      .medium = {.transport = Transport::kConsistent, .look = {.detail = true}}};
  EXPECT_EQ(first(detailed, LightVolume{}), Stage::kLight);
  EXPECT_EQ(first(HalfAngle{}, LightVolume{}), Stage::kExtinction);  // the light volume has detail
  EXPECT_EQ(first(HalfAngle{}, Metaballs{}), Stage::kExtinction);    // as metaballs' surfaces have
}

TEST(Scene, LightsCountWhereTheyAreShown) {
  Scene before;
  const auto first = [&](const auto& change) {
    Scene after = before;
    change(&after.lights);
    return FirstDirtyStage(before, after);
  };
  using Lights = std::vector<DirectionalLight>;
  for (const Technique& technique : {Technique(Metaballs{}), Technique(Reference{})}) {
    before.lights = {{75.0, 20.0, glm::dvec3(1.0), 1.0}};
    before.rendering.technique = technique;
    EXPECT_EQ(first([](Lights*) {}), Stage::kNothing);
    EXPECT_EQ(first([](Lights* lights) { lights->clear(); }), Stage::kLight);
    EXPECT_EQ(first([](Lights* lights) { lights->emplace_back(); }), Stage::kLight);
    EXPECT_EQ(first([](Lights* lights) { lights->front().elevation_deg = 3.0; }), Stage::kLight);
    EXPECT_EQ(first([](Lights* lights) { lights->front().color.r = 0.5; }), Stage::kView);
    EXPECT_EQ(first([](Lights* lights) { lights->front().irradiance = 0.5; }), Stage::kView);
  }
  // These techniques do not draw the additional lights. The frame reports that.
  for (const Technique& technique :
       {Technique(LightVolume{}), Technique(HalfAngle{}), Technique(Cumulus{})}) {
    before.rendering.technique = technique;
    EXPECT_EQ(first([](Lights* lights) { lights->front().elevation_deg = 3.0; }), Stage::kTone);
    EXPECT_EQ(first([](Lights* lights) { lights->clear(); }), Stage::kTone);
  }
}

TEST(Scene, DetailCountsOnlyWhereItIsShown) {
  Scene before;
  before.rendering.technique = HalfAngle{};
  Scene after = before;
  after.fields[0].detail.seed = 7;
  EXPECT_EQ(FirstDirtyStage(before, after), Stage::kNothing);
  before.rendering.technique = after.rendering.technique =
      HalfAngle{.medium = {.look = {.detail = true}}};
  EXPECT_EQ(FirstDirtyStage(before, after), Stage::kExtinction);
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

// Returns the elevation of a world point above the horizon of the view's eye.
double ElevationSeen_deg(const View& view, const glm::dvec3& point_m) {
  const glm::dvec3 ray = glm::normalize(view.local_from_world * (point_m - view.eye_m));
  return std::asin(ray.z) * 180.0 / std::numbers::pi;
}

TEST(SpotterView, LooksWhereItsAzimuthAndElevationSay) {
  SpotterCamera camera;
  camera.place_m = {-30e3, -40e3};
  camera.azimuth_deg = 70.0;
  camera.elevation_deg = 12.0;
  const View view = ViewOf(camera, {200.0, {10e3, 5e3}}, 16.0 / 9.0);
  const glm::dvec3 looks = view.local_from_world * view.forward;
  EXPECT_LT(glm::distance(looks, Direction(70.0, 12.0)), 1e-12);
  EXPECT_LT(glm::distance(view.local_from_world * view.right, Direction(160.0, 0.0)), 1e-12);
  EXPECT_NEAR(view.altitude_m, 201.7, 1e-9);
  // At the storm's middle the view is not tilted.
  camera.place_m = {10e3, 5e3};
  EXPECT_LT(
      glm::distance(ViewOf(camera, {200.0, {10e3, 5e3}}, 1.0).eye_m, glm::dvec3(10e3, 5e3, 201.7)),
      1e-6);
}

TEST(SpotterView, DistantStormsSinkBelowTheHorizon) {
  // The expected elevation comes from the triangle of the Earth's centre, the eye and a point above
  // the storm's middle. The view approximates it to third order in the angle at the centre. The
  // error is about 8e-6 radians at 150 km.
  for (const double distance_m : {20e3, 80e3, 150e3}) {
    SpotterCamera camera;
    camera.place_m = {5e3, -distance_m};
    const View view = ViewOf(camera, {300.0, {5e3, 0.0}}, 1.5);
    for (const double height_m : {300.0, 1500.0, 12e3}) {
      const double angle = distance_m / kEffectiveEarthRadius_m;
      const double point_m = kEffectiveEarthRadius_m + height_m;
      const double eye_m = kEffectiveEarthRadius_m + view.altitude_m;
      const double rise_m = point_m * std::cos(angle) - eye_m;
      const double expected_deg =
          std::atan2(rise_m, point_m * std::sin(angle)) * 180.0 / std::numbers::pi;
      EXPECT_NEAR(ElevationSeen_deg(view, {5e3, 0.0, height_m}), expected_deg, 1e-3)
          << distance_m << " m away, " << height_m << " m high";
      const double drop_m = distance_m * distance_m / (2.0 * kEffectiveEarthRadius_m);
      EXPECT_NEAR(rise_m, height_m - view.altitude_m - drop_m, 1e-3 * drop_m + 3.0)
          << distance_m << " m away, " << height_m << " m high";
    }
  }
}

TEST(OrbitView, SeesTheGroundFallAwayFromTheStorm) {
  OrbitCamera camera;
  camera.azimuth_deg = 180.0;
  camera.elevation_deg = 0.0;
  camera.distance_m = 100e3;
  const View view = ViewOf(camera, {0.0, {0.0, 0.0}}, 1.5);
  EXPECT_LT(glm::distance(view.eye_m, glm::dvec3(0.0, -100e3, 0.0)), 1e-6);
  EXPECT_NEAR(view.altitude_m, 672.7, 0.1);
  // A level direction in the world descends for the eye, whose vertical leans away.
  EXPECT_NEAR((view.local_from_world * view.forward).z, -100e3 / kEffectiveEarthRadius_m, 1e-5);
}

TEST(OrbitView, LooksDownOnWideDomains) {
  const glm::dvec3 low_m(-100.0, -200.0, 1000.0);
  EXPECT_DOUBLE_EQ(FramingElevation_deg(low_m, low_m + glm::dvec3(80e3, 40e3, 14e3)), 4.0);
  EXPECT_DOUBLE_EQ(FramingElevation_deg(low_m, low_m + glm::dvec3(10e3, 9e3, 1e3)), 4.0);
  EXPECT_DOUBLE_EQ(FramingElevation_deg(low_m, low_m + glm::dvec3(500e3, 1000e3, 14e3)), 35.0);
  const double between_deg = FramingElevation_deg(low_m, low_m + glm::dvec3(300e3, 40e3, 14e3));
  EXPECT_GT(between_deg, 15.0);
  EXPECT_LT(between_deg, 25.0);
  EXPECT_DOUBLE_EQ(FramingElevation_deg(low_m, low_m), 35.0) << "of nothing, and finite";
}

TEST(SpotterView, ThePictureIsCutOutOfTheFrame) {
  SpotterCamera camera;
  camera.focal_length_mm = 36.0;
  const View wide = ViewOf(camera, Site(), 2.0);
  EXPECT_NEAR(wide.tan_half_width, 0.5, 1e-12);
  EXPECT_NEAR(wide.tan_half_height, 0.25, 1e-12);
  const View narrow = ViewOf(camera, Site(), 0.5);
  EXPECT_NEAR(narrow.tan_half_height, 1.0 / 3.0, 1e-12);
  EXPECT_NEAR(narrow.tan_half_width, 1.0 / 6.0, 1e-12);
}

TEST(SpotterView, FramingShowsTheStormAndItsHorizon) {
  const glm::dvec3 low(-50e3, -20e3, 0);
  const glm::dvec3 high(60e3, 30e3, 15e3);
  SpotterCamera camera = Framing(SpotterCamera(), low, high, 16.0 / 9.0);
  camera = LookingAt(camera, low, high);
  const View view = ViewOf(camera, {0.0, {5e3, 5e3}}, 16.0 / 9.0);
  for (const glm::dvec3 point : {glm::dvec3(5e3, 5e3, 15e3), glm::dvec3(5e3, 5e3, 2e3),
                                 glm::dvec3(-50e3, 5e3, 5e3), glm::dvec3(60e3, 5e3, 5e3)}) {
    const glm::dvec3 offset = point - view.eye_m;
    const double depth = glm::dot(offset, view.forward);
    ASSERT_GT(depth, 0.0);
    EXPECT_LT(std::abs(glm::dot(offset, view.right)) / depth, view.tan_half_width);
    EXPECT_LT(std::abs(glm::dot(offset, view.up)) / depth, view.tan_half_height);
  }
  EXPECT_LT(camera.elevation_deg, std::atan(view.tan_half_height) * 180.0 / std::numbers::pi)
      << "the horizon should be in the picture";
}

TEST(TopDownView, HasNorthAboveAndEastAtTheRight) {
  const glm::dvec3 low(-50e3, -20e3, 0);
  const glm::dvec3 high(60e3, 30e3, 15e3);
  const TopDownCamera camera = Framing(TopDownCamera(), low, high, 1.0);
  EXPECT_NEAR(camera.width_m, 1.05 * 110e3, 1e-6);
  EXPECT_EQ(camera.center_m, glm::dvec2(5e3, 5e3));
  const View view = ViewOf(camera, 2.0);
  EXPECT_TRUE(view.Orthographic());
  EXPECT_EQ(view.forward, glm::dvec3(0, 0, -1));
  EXPECT_EQ(view.right, glm::dvec3(1, 0, 0));
  EXPECT_EQ(view.up, glm::dvec3(0, 1, 0));
  EXPECT_NEAR(view.half_height_m, view.half_width_m / 2.0, 1e-9);
  EXPECT_EQ(view.tan_half_width, 0.0);
}

}  // namespace
}  // namespace thunderhead::scene
