// The light from the ground that arrives at a place, against closed forms.
#include "renderers/lit_ground.h"

#include <cmath>
#include <functional>

#include "glm/geometric.hpp"
#include "gtest/gtest.h"

namespace thunderhead::renderers {
namespace {

constexpr double kTexel_m = 200.0;

// 51.2 km wide around the origin, at a height of 300 m.
GroundMap MapOf(const std::function<float(const glm::dvec2& place_m)>& share) {
  GroundMap map;
  map.size = {256, 256};
  map.texel_m = glm::dvec2(kTexel_m);
  map.low_m = -128.0 * map.texel_m;
  for (int y = 0; y < map.size.y; ++y) {
    for (int x = 0; x < map.size.x; ++x) {
      map.share.push_back(share(map.low_m + (glm::dvec2(x, y) + 0.5) * map.texel_m));
    }
  }
  map.height_m.assign(map.share.size(), 300.0F);
  return map;
}

LitGround DarkDisc(double radius_m, float share = 0.0F) {
  return LitGround(MapOf(
      [=](const glm::dvec2& place_m) { return glm::length(place_m) < radius_m ? share : 1.0F; }));
}

TEST(LitGround, OpenGroundIsLitAlike) {
  EXPECT_EQ(LitGround().ShareAt({0.0, 0.0, 500.0}), 1.0F);
  const LitGround open(MapOf([](const glm::dvec2&) { return 1.0F; }));
  for (const double height_m : {300.0, 900.0, 2e4}) {
    EXPECT_FLOAT_EQ(open.ShareAt({-7e3, 25e3, height_m}), 1.0F);
  }
}

TEST(LitGround, AboveADarkDiscComesWhatALevelFaceGets) {
  // A face at the height h above a disc of radius a gets a^2 / (a^2 + h^2) of its light from there.
  for (const double radius_m : {1000.0, 3000.0, 9000.0}) {
    const LitGround ground = DarkDisc(radius_m);
    for (const double height_m : {700.0, 1500.0, 3000.0, 6000.0, 12000.0}) {
      const double dark = 1.0 / (1.0 + std::pow(height_m / radius_m, 2.0));
      // The tolerance covers LitGround's approximation of the ground by three squares for discs.
      EXPECT_NEAR(ground.ShareAt({0.0, 0.0, 300.0 + height_m}), 1.0 - dark, 0.07)
          << radius_m << ' ' << height_m;
    }
  }
}

TEST(LitGround, AboveTheEdgeOfAShadowHalfOfTheGroundIsLit) {
  const LitGround ground(
      MapOf([](const glm::dvec2& place_m) { return place_m.x < 0.0 ? 0.2F : 1.0F; }));
  for (const double height_m : {0.0, 500.0, 2000.0}) {
    EXPECT_NEAR(ground.ShareAt({0.0, 0.0, 300.0 + height_m}), 0.6, 0.01) << height_m;
  }
  // At a distance d from it, (1 - d / sqrt(d^2 + h^2)) / 2 of a level face's light is from beyond;
  // of that the outermost of the three discs alone has the far part.
  for (const double away_m : {1000.0, 2500.0, 6000.0}) {
    constexpr double kHeight_m = 2000.0;
    const double beyond = 0.5 * (1.0 - away_m / std::hypot(away_m, kHeight_m));
    EXPECT_NEAR(ground.ShareAt({-away_m, 0.0, 300.0 + kHeight_m}), 0.2 + 0.8 * beyond, 0.1);
    EXPECT_NEAR(ground.ShareAt({away_m, 0.0, 300.0 + kHeight_m}), 1.0 - 0.8 * beyond, 0.1);
  }
}

TEST(LitGround, AWallSeesTheGroundOnItsSide) {
  // Above the edge of a shadow a wall sees one half of the ground, and nothing of the other.
  const LitGround ground(
      MapOf([](const glm::dvec2& place_m) { return place_m.x < 0.0 ? 0.0F : 1.0F; }));
  const glm::dvec3 place_m(0.0, 0.0, 1800.0);
  EXPECT_GT(ground.ShareAt(place_m, {1.0F, 0.0F, 0.0F}), 0.8F);
  EXPECT_LT(ground.ShareAt(place_m, {-1.0F, 0.0F, 0.0F}), 0.2F);
  EXPECT_NEAR(ground.ShareAt(place_m, {0.0F, 1.0F, 0.0F}), 0.5, 0.01);
}

TEST(LitGround, CloseToTheGroundItIsThatBelow) {
  const LitGround ground = DarkDisc(3000.0, 0.1F);
  EXPECT_NEAR(ground.ShareAt({500.0, 500.0, 300.0}), 0.1, 1e-5);
  EXPECT_NEAR(ground.ShareAt({500.0, 500.0, 100.0}), 0.1, 1e-5);  // below it, in coarse terrain
  EXPECT_NEAR(ground.ShareAt({5000.0, 0.0, 300.0}), 1.0, 1e-5);
  EXPECT_NEAR(ground.ShareAt({5e5, 0.0, 300.0}), 1.0, 1e-5);
}

TEST(LitGround, FarAboveTheMapItsDarkIsASmallSpot) {
  const LitGround dark(MapOf([](const glm::dvec2&) { return 0.0F; }));
  double before = 0.0;
  for (const double height_m : {3e4, 1e5, 1e6}) {
    const double share = dark.ShareAt({0.0, 0.0, 300.0 + height_m});
    EXPECT_GT(share, before) << height_m;
    before = share;
  }
  EXPECT_NEAR(before, 1.0, 0.01);
}

}  // namespace
}  // namespace thunderhead::renderers
