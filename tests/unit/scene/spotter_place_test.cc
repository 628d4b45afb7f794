#include "scene/spotter_place.h"

#include <cmath>

#include "glm/geometric.hpp"
#include "glm/trigonometric.hpp"
#include "gtest/gtest.h"
#include "scene/view.h"
#include "storm_store/storm_store.h"
#include "volume/core_sight.h"

namespace thunderhead::scene {
namespace {

constexpr double kAspectRatio = 16.0 / 9.0;

// Returns a storm of 60 x 60 x 16 km with a tower of 4 x 4 km from 1 to 12 km at its middle. Its
// fields are cloud and rain.
volume::HydrometeorFields SpottedStorm() {
  volume::HydrometeorFields fields;
  fields.grid = {{60, 60, 32}, {1000.0, 1000.0, 500.0}, {-30e3, -30e3, 0.0}};
  fields.condensate = {{0, 0, 0}, fields.grid.cells};
  fields.fields.resize(2);
  fields.fields[0].hydrometeor = physics::Hydrometeor::kCloud;
  fields.fields[1].hydrometeor = physics::Hydrometeor::kRain;
  for (auto& field : fields.fields) {
    field.concentration_kg_per_m3.assign(fields.grid.CellCount(), 0.0F);
  }
  return fields;
}

void Fill(volume::HydrometeorFields& fields, int field, const glm::ivec3& low,
          const glm::ivec3& high) {
  auto& cells = fields.fields[static_cast<std::size_t>(field)].concentration_kg_per_m3;
  for (int z = low.z; z < high.z; ++z) {
    for (int y = low.y; y < high.y; ++y) {
      for (int x = low.x; x < high.x; ++x) cells[fields.grid.Offset(x, y, z)] = 4e-3F;
    }
  }
}

volume::HydrometeorFields Thunderstorm() {
  volume::HydrometeorFields fields = SpottedStorm();
  Fill(fields, 0, {28, 28, 2}, {32, 32, 24});
  return fields;
}

// Returns the spotter's camera under a sun in the zenith, which lights all sides equally.
SpotterCamera Spotted(const volume::HydrometeorFields& fields, SpotterCamera camera = {},
                      SpottersSide side = SpottersSide::kBest,
                      const glm::dvec3& towards_sun = {0.0, 0.0, 1.0}) {
  const auto core = volume::StrongestCore(fields);
  EXPECT_TRUE(core.has_value());
  return SpottingCore(camera, side, fields, *core, physics::SizeSource::kModel, towards_sun,
                      kAspectRatio);
}

double Distance_m(const SpotterCamera& camera, const volume::HydrometeorFields& fields) {
  return glm::distance(camera.place_m, volume::StrongestCore(fields)->place_m);
}

// Returns the height in the picture, from -1 at its lower edge to 1 at its upper edge.
double HeightInPicture(const SpotterCamera& camera, const volume::HydrometeorFields& fields,
                       const glm::dvec3& point_m) {
  const View view = ViewOf(camera, SiteOf(fields, camera.place_m), kAspectRatio);
  const glm::dvec3 offset_m = point_m - view.eye_m;
  return glm::dot(offset_m, view.up) / glm::dot(offset_m, view.forward) / view.tan_half_height;
}

double HeightOfTop(const SpotterCamera& camera, const volume::HydrometeorFields& fields) {
  const auto core = volume::StrongestCore(fields);
  return HeightInPicture(camera, fields, {core->place_m, core->top_m});
}

// Returns the share of the picture's height below the horizon of a low eye.
double GroundShare(const SpotterCamera& camera) {
  const double tan_half_height = ViewOf(camera, Site(), kAspectRatio).tan_half_height;
  return 0.5 - 0.5 * std::tan(glm::radians(camera.elevation_deg)) / tan_half_height;
}

TEST(SpotterPlace, TheRainIsBehindTheTower) {
  volume::HydrometeorFields fields = Thunderstorm();
  Fill(fields, 1, {20, 20, 0}, {40, 27, 8});
  const SpotterCamera from_north = Spotted(fields);
  EXPECT_GT(from_north.place_m.y, 10e3);
  const SpotterCamera from_west = [] {
    volume::HydrometeorFields turned = Thunderstorm();
    Fill(turned, 1, {33, 15, 0}, {40, 45, 8});
    Fill(turned, 1, {20, 15, 0}, {40, 27, 8});
    return Spotted(turned);
  }();
  EXPECT_LT(from_west.place_m.x, 0.0);
  EXPECT_GT(from_west.place_m.y, 0.0);
}

TEST(SpotterPlace, TheSunIsNotBehindTheTower) {
  const volume::HydrometeorFields fields = Thunderstorm();
  for (const double azimuth_deg : {20.0, 120.0, 275.0}) {
    const auto turn_deg = [&](double elevation_deg) {
      const SpotterCamera camera =
          Spotted(fields, {}, SpottersSide::kBest, Direction(azimuth_deg, elevation_deg));
      return std::abs(std::remainder(camera.azimuth_deg - azimuth_deg, 360.0));
    };
    EXPECT_GE(turn_deg(18.0), 75.0) << azimuth_deg;
    EXPECT_NEAR(turn_deg(-3.0), std::abs(std::remainder(20.0 - azimuth_deg, 360.0)), 1e-3);
  }
}

TEST(SpotterPlace, ABaseWithoutRainCountsMoreThanALittleLight) {
  volume::HydrometeorFields fields = Thunderstorm();
  Fill(fields, 1, {20, 20, 0}, {40, 27, 8});  // rain to the south of the tower
  const SpotterCamera camera = Spotted(fields, {}, SpottersSide::kBest, Direction(180.0, 70.0));
  EXPECT_GT(camera.place_m.y, -5e3);
}

TEST(SpotterPlace, TheWholeTowerAndALittleGroundAreInThePicture) {
  const volume::HydrometeorFields fields = Thunderstorm();
  const SpotterCamera camera = Spotted(fields);
  EXPECT_GE(Distance_m(camera, fields), 15e3);
  EXPECT_LE(Distance_m(camera, fields), 25e3);
  EXPECT_LT(HeightOfTop(camera, fields), 0.9);
  EXPECT_GT(HeightOfTop(camera, fields), 0.5);
  EXPECT_GE(GroundShare(camera), 0.16);
  EXPECT_LE(GroundShare(camera), 0.251);
  // If all sides are equal, the spotter looks in the default direction.
  EXPECT_NEAR(camera.azimuth_deg, SpotterCamera().azimuth_deg, 1e-6);
}

TEST(SpotterPlace, AWideLensIsNearAndALongLensKeepsTheBase) {
  const volume::HydrometeorFields fields = Thunderstorm();
  const SpotterCamera wide = Spotted(fields, {.focal_length_mm = 14.0});
  EXPECT_NEAR(Distance_m(wide, fields), 15e3, 1.0);
  EXPECT_NEAR(GroundShare(wide), 0.25, 0.005);
  EXPECT_LT(HeightOfTop(wide, fields), 0.9);
  const SpotterCamera tele = Spotted(fields, {.focal_length_mm = 100.0});
  EXPECT_NEAR(Distance_m(tele, fields), 25e3, 500.0);
  EXPECT_GT(HeightOfTop(tele, fields), 1.0);
  EXPECT_NEAR(GroundShare(tele), 1.0 / 6.0, 0.005);
}

TEST(SpotterPlace, LowCloudsAreSeenFromNear) {
  volume::HydrometeorFields fields = SpottedStorm();
  fields.grid = {{100, 100, 25}, {100.0, 100.0, 100.0}, {-5e3, -5e3, 0.0}};
  fields.condensate = {{0, 0, 0}, fields.grid.cells};
  for (auto& field : fields.fields) {
    field.concentration_kg_per_m3.assign(fields.grid.CellCount(), 0.0F);
  }
  Fill(fields, 0, {47, 47, 6}, {53, 53, 18});
  const SpotterCamera camera = Spotted(fields);
  EXPECT_GT(Distance_m(camera, fields), 1.25 * 1.8e3 - 1.0);
  EXPECT_LT(Distance_m(camera, fields), 2.1 * 1.8e3);
  EXPECT_LT(HeightOfTop(camera, fields), 0.9);
}

TEST(SpotterPlace, ACoreAtTheEdgeIsSeenFromWithinTheDomain) {
  volume::HydrometeorFields fields = SpottedStorm();
  // The second tower is cut by the domain's western face.
  Fill(fields, 0, {0, 28, 2}, {3, 32, 24});
  EXPECT_GT(Spotted(fields).place_m.x, -30e3);
}

TEST(SpotterPlace, TheEyeIsInClearAir) {
  volume::HydrometeorFields fields = Thunderstorm();
  // It rains over the whole domain.
  Fill(fields, 1, {0, 0, 0}, {60, 60, 8});
  const SpotterCamera outside = Spotted(fields);
  const auto core = volume::StrongestCore(fields);
  const volume::CoreSight sight(fields, *core);
  EXPECT_TRUE(sight.IsClear(glm::dvec3(outside.place_m, 1.7)));
  EXPECT_GT(glm::length(outside.place_m), 29e3);
  // If the rain has a gap, the spotter stands in this gap.
  auto& rain = fields.fields[1].concentration_kg_per_m3;
  for (int z = 0; z < 8; ++z) {
    for (int x = 45; x < 52; ++x) {
      for (int y = 25; y < 35; ++y) rain[fields.grid.Offset(x, y, z)] = 0.0F;
    }
  }
  const SpotterCamera in_gap = Spotted(fields);
  EXPECT_TRUE(sight.IsClear(glm::dvec3(in_gap.place_m, 1.7)));
  EXPECT_LE(Distance_m(in_gap, fields), 25e3);
  EXPECT_GT(in_gap.place_m.x, 15e3);
}

TEST(SpotterPlace, AGivenAzimuthDecidesTheSide) {
  volume::HydrometeorFields fields = Thunderstorm();
  Fill(fields, 1, {20, 20, 0}, {40, 27, 8});
  const SpotterCamera camera =
      Spotted(fields, {.azimuth_deg = 10.0}, SpottersSide::kOppositeAzimuth);
  EXPECT_NEAR(camera.azimuth_deg, 10.0, 1e-9);
  EXPECT_LT(camera.place_m.y, -14e3);
  EXPECT_LT(HeightOfTop(camera, fields), 0.9);
}

TEST(SpotterPlace, ShowsTheTowersOfTheSampleStorm) {
  const auto store =
      storm_store::StormStore::Open({THUNDERHEAD_SOURCE_DIR "/samples/supercell.nc"}, {});
  ASSERT_TRUE(store.ok());
  for (int time = 0; time < 4; ++time) {
    SCOPED_TRACE(time);
    const auto fields = (*store)->Get("supercell", time, {});
    ASSERT_TRUE(fields.ok());
    const SpotterCamera camera = Spotted(**fields);
    EXPECT_GE(Distance_m(camera, **fields), 15e3);
    // At later times the anvil is above the spotter at the usual distance, so the spotter stands
    // farther away.
    EXPECT_LE(Distance_m(camera, **fields), time < 2 ? 25e3 : 50e3);
    EXPECT_LT(HeightOfTop(camera, **fields), 0.9);
    EXPECT_GE(GroundShare(camera), 0.16);
    EXPECT_LE(GroundShare(camera), 0.251);
    const auto core = volume::StrongestCore(**fields);
    const volume::CoreSight sight(**fields, *core);
    const glm::dvec3 eye_m(camera.place_m, 1.7);
    EXPECT_TRUE(sight.IsClear(eye_m));
    const double upper_edge = glm::radians(camera.elevation_deg) +
                              std::atan(ViewOf(camera, Site(), kAspectRatio).tan_half_height);
    EXPECT_LT(sight.HiddenSky(eye_m, upper_edge), 0.3);
    // The first rain of the young tower falls through its base, on all sides.
    if (time == 0) continue;
    EXPECT_LT(sight.HiddenBase(eye_m), 0.15);
    const glm::dvec3 opposite_m(2.0 * core->place_m - camera.place_m, 1.7);
    EXPECT_GT(sight.HiddenBase(opposite_m), 0.8);
  }
}

}  // namespace
}  // namespace thunderhead::scene
