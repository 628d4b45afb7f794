#include "renderers/metaball/tiles.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "glm/geometric.hpp"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::renderers {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::IsEmpty;

Ball At(const glm::dvec3& middle_m, double radius_m) {
  Ball ball;
  ball.middle_m = middle_m;
  ball.radius_m = radius_m;
  return ball;
}

std::vector<std::uint32_t> ListAt(const BallTiles& tiles, const glm::ivec2& pixel) {
  const glm::ivec2 tile = pixel / tiles.tile_px;
  const auto at = static_cast<std::size_t>(tile.y * tiles.tiles.x + tile.x);
  return {tiles.balls.begin() + tiles.starts[at], tiles.balls.begin() + tiles.starts[at + 1]};
}

// Expects that each ball that a ray meets is in the list of its tile, with the nearest first.
void ExpectAllListed(const std::vector<Ball>& balls, const scene::View& view,
                     const glm::ivec2& size_px) {
  const BallTiles tiles = TilesOf(balls, view, size_px);
  for (int y = 0; y < size_px.y; ++y) {
    for (int x = 0; x < size_px.x; ++x) {
      const double right = 2.0 * (x + 0.5) / size_px.x - 1.0;
      const double up = 2.0 * (y + 0.5) / size_px.y - 1.0;
      const glm::dvec3 origin_m =
          view.eye_m + right * view.half_width_m * view.right + up * view.half_height_m * view.up;
      const glm::dvec3 ray =
          glm::normalize(view.forward + right * view.tan_half_width * view.right +
                         up * view.tan_half_height * view.up);
      const std::vector<std::uint32_t> list = ListAt(tiles, {x, y});
      for (std::uint32_t i = 0; i < balls.size(); ++i) {
        const glm::dvec3 off_m = balls[i].middle_m - origin_m;
        const double along_m = glm::dot(off_m, ray);
        const bool met =
            glm::length(off_m - along_m * ray) < balls[i].radius_m && along_m > -balls[i].radius_m;
        const bool before = glm::length(off_m) < balls[i].radius_m;
        if (!(met && (along_m > 0.0 || before))) continue;
        ASSERT_NE(std::find(list.begin(), list.end(), i), list.end())
            << "ball " << i << " at " << x << ' ' << y;
      }
    }
  }
}

std::vector<Ball> Cloud() {
  std::vector<Ball> balls;
  unsigned state = 7;
  const auto random = [&state] {
    state = state * 1664525U + 1013904223U;
    return (state >> 8U) / 16777216.0;
  };
  for (int i = 0; i < 200; ++i) {
    const glm::dvec3 middle_m(2000.0 * random() - 1000.0, 2000.0 * random() - 1000.0,
                              2000.0 * random());
    balls.push_back(At(middle_m, 10.0 + 300.0 * random()));
  }
  return balls;
}

TEST(BallTiles, HoldEveryBallThatARayMeets) {
  scene::OrbitCamera camera;
  camera.target_m = {0.0, 0.0, 1000.0};
  // The views are from outside, from inside, from far away and along the axes.
  for (const double distance_m : {5000.0, 300.0, 1.0, 1e6}) {
    for (const double azimuth_deg : {0.0, 33.0}) {
      camera.distance_m = distance_m;
      camera.azimuth_deg = azimuth_deg;
      camera.elevation_deg = azimuth_deg;
      camera.field_of_view_deg = distance_m > 1e5 ? 1.0 : 50.0;
      ExpectAllListed(Cloud(), scene::ViewOf(camera, 1.5), {90, 60});
    }
  }
  ExpectAllListed(Cloud(), scene::ViewOf(scene::TopDownCamera{{200.0, 0.0}, 1500.0}, 1.5),
                  {90, 60});
}

TEST(BallTiles, TheNearestIsFirst) {
  const scene::View view = scene::ViewOf(scene::TopDownCamera{{0.0, 0.0}, 100.0}, 1.0);
  const BallTiles tiles =
      TilesOf({At({0.0, 0.0, 10.0}, 5.0), At({0.0, 0.0, 90.0}, 5.0), At({0.0, 0.0, 50.0}, 5.0)},
              view, {8, 8});
  EXPECT_THAT(ListAt(tiles, {4, 4}), ElementsAre(1, 2, 0));
}

TEST(BallTiles, WhatIsOutOfSightIsInNoList) {
  scene::OrbitCamera camera;
  camera.target_m = glm::dvec3(0.0);
  camera.distance_m = 1000.0;
  camera.azimuth_deg = 180.0;  // the camera looks north
  camera.elevation_deg = 0.0;
  const scene::View view = scene::ViewOf(camera, 1.0);
  const BallTiles tiles =
      TilesOf({At({0.0, -5000.0, 0.0}, 100.0), At({9000.0, 0.0, 0.0}, 100.0)}, view, {64, 64});
  EXPECT_THAT(tiles.balls, IsEmpty());
  EXPECT_THAT(tiles.starts, Each(0U));
}

TEST(BallTiles, ManyBallsOverAllOfThePictureHaveLargerTiles) {
  const std::vector<Ball> balls(20000, At({0.0, 0.0, 0.0}, 1e6));
  scene::OrbitCamera camera;
  camera.distance_m = 10.0;
  const BallTiles tiles = TilesOf(balls, scene::ViewOf(camera, 1.0), {1024, 1024});
  EXPECT_GT(tiles.tile_px, 16);
  EXPECT_LE(tiles.balls.size(), std::size_t{1} << 22U);
  EXPECT_EQ(ListAt(tiles, {500, 500}).size(), balls.size());
}

}  // namespace
}  // namespace thunderhead::renderers
