// Tests of the light from the ground that arrives at a place, against closed forms.
#include "renderers/lit_ground.h"

#include <cmath>
#include <functional>
#include <limits>

#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "gtest/gtest.h"

namespace thunderhead::renderers {
namespace {

constexpr double kTexel_m = 200.0;

// Returns a map 51.2 km wide around the origin, at a height of 300 m.
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

// Maps may have any shape. On the ground, the fraction of lit ground is the map's value,
// interpolated.
TEST(LitGround, OnTheGroundItIsTheMap) {
  for (const glm::ivec2& size :
       {glm::ivec2(1), glm::ivec2(1, 7), glm::ivec2(5, 192), glm::ivec2(3, 2)}) {
    GroundMap map;
    map.size = size;
    map.texel_m = {200.0, 500.0};
    map.low_m = {-1000.0, 3000.0};
    for (int i = 0; i < size.x * size.y; ++i) {
      map.share.push_back(0.1F * static_cast<float>(i % 7));
      map.height_m.push_back(50.0F);
    }
    const LitGround ground(map);
    const auto dark = [&](int x, int y) {
      if (x < 0 || y < 0 || x >= size.x || y >= size.y) return 0.0;
      return 1.0 - static_cast<double>(map.share[static_cast<std::size_t>(y * size.x + x)]);
    };
    for (double y = -2.25; y < size.y + 2.0; y += 0.75) {
      for (double x = -2.25; x < size.x + 2.0; x += 0.75) {
        const double west = std::floor(x - 0.5);
        const double south = std::floor(y - 0.5);
        const glm::ivec2 at(west, south);
        const glm::dvec2 share(x - 0.5 - west, y - 0.5 - south);
        const double expected =
            glm::mix(glm::mix(dark(at.x, at.y), dark(at.x + 1, at.y), share.x),
                     glm::mix(dark(at.x, at.y + 1), dark(at.x + 1, at.y + 1), share.x), share.y);
        const glm::dvec2 place_m = map.low_m + glm::dvec2(x, y) * map.texel_m;
        ASSERT_NEAR(ground.ShareAt({place_m, 50.0}), 1.0 - expected, 1e-5)
            << size.x << " x " << size.y << ": " << x << ", " << y;
      }
    }
  }
}

TEST(LitGround, WhatIsNoNumberIsLookedUpNowhereElse) {
  const float none = std::numeric_limits<float>::quiet_NaN();
  const LitGround ground = DarkDisc(3000.0);
  (void)ground.ShareAt({0.0, 0.0, 900.0}, glm::vec3(none));
  (void)ground.ShareAt(glm::dvec3(static_cast<double>(none)));
  (void)ground.ShareAt({1e30, -1e30, 900.0}, glm::vec3(1e30F));
}

TEST(LitGround, AboveADarkDiscComesWhatALevelFaceGets) {
  // A face at height h above a disc of radius a gets a^2 / (a^2 + h^2) of its light from the disc.
  for (const double radius_m : {1000.0, 3000.0, 9000.0}) {
    const LitGround ground = DarkDisc(radius_m);
    for (const double height_m : {700.0, 1500.0, 3000.0, 6000.0, 12000.0}) {
      const double dark = 1.0 / (1.0 + std::pow(height_m / radius_m, 2.0));
      // The tolerance covers LitGround's approximation of the ground by three squares instead of
      // discs.
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
  // At a distance d from the edge, (1 - d / sqrt(d^2 + h^2)) / 2 of a level face's light is from
  // beyond it. Only the outermost of the three discs contains the far part.
  for (const double away_m : {1000.0, 2500.0, 6000.0}) {
    constexpr double kHeight_m = 2000.0;
    const double beyond = 0.5 * (1.0 - away_m / std::hypot(away_m, kHeight_m));
    EXPECT_NEAR(ground.ShareAt({-away_m, 0.0, 300.0 + kHeight_m}), 0.2 + 0.8 * beyond, 0.1);
    EXPECT_NEAR(ground.ShareAt({away_m, 0.0, 300.0 + kHeight_m}), 1.0 - 0.8 * beyond, 0.1);
  }
}

TEST(LitGround, AWallSeesTheGroundOnItsSide) {
  // Above the edge of a shadow a wall sees one half of the ground, and nothing of the other half.
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
  EXPECT_NEAR(ground.ShareAt({500.0, 500.0, 100.0}), 0.1,
              1e-5);  // a place below the coarse terrain
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
