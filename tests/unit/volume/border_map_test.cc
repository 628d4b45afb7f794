#include "volume/border_map.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "glm/geometric.hpp"
#include "glm/gtc/packing.hpp"
#include "gtest/gtest.h"
#include "tests/support/border_files.h"

namespace thunderhead::volume {
namespace {

using testing::PaintedAt;

constexpr double kTexel_m = 500.0;

BorderGrid Square(int texels, double fades_m = 0.0) {
  return {{-10e3, -20e3}, kTexel_m, {texels, texels}, fades_m};
}

double Distance_m(const BorderLine& line, const glm::dvec2& place_m) {
  double nearest_m = 1e9;
  for (std::size_t i = 1; i < line.points_m.size(); ++i) {
    const glm::dvec2 from = line.points_m[i - 1];
    const glm::dvec2 along = line.points_m[i] - from;
    const double share =
        std::clamp(glm::dot(place_m - from, along) / glm::dot(along, along), 0.0, 1.0);
    nearest_m = std::min(nearest_m, glm::distance(place_m, from + share * along));
  }
  return nearest_m;
}

// The line is far thinner than a texel, in any direction and at any place between texels.
TEST(BorderMapTest, AStraightLineIsPaintedAsWideAsItIs) {
  const glm::dvec2 from_m(-7'873.0, -16'821.0);
  for (const glm::dvec2 to_m : {glm::dvec2(40e3, -16'821.0), glm::dvec2(-7'873.0, 30e3),
                                glm::dvec2(37e3, 9e3), glm::dvec2(11e3, 29e3)}) {
    const BorderLine line{{from_m, to_m}, 1.0F};
    const BorderMap map = MakeBorderMap({line}, Square(100));
    const glm::dvec2 along = glm::normalize(to_m - from_m);
    const glm::dvec2 across(-along.y, along.x);
    for (double way_m = 3000.0; way_m < 35e3; way_m += 377.0) {
      const glm::dvec2 on_line_m = from_m + way_m * along;
      EXPECT_GT(PaintedAt(map, on_line_m), 0.99F) << on_line_m.x << ' ' << on_line_m.y;
      for (const double side : {-1.0, 1.0}) {
        EXPECT_GT(PaintedAt(map, on_line_m + side * 57.0 * across), 0.99F) << way_m;
        EXPECT_LT(PaintedAt(map, on_line_m + side * 63.0 * across), 0.01F) << way_m;
      }
    }
  }
}

TEST(BorderMapTest, DistancesAreThoseToTheNearestOfManyLines) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any_m(-10e3, 40e3);
  std::vector<BorderLine> lines;
  for (int i = 0; i < 12; ++i) {
    BorderLine& line = lines.emplace_back();
    for (int j = 0; j < 4; ++j) line.points_m.emplace_back(any_m(random), any_m(random) - 10e3);
  }
  const BorderMap map = MakeBorderMap(lines, Square(100));
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 100; ++x) {
      const glm::dvec2 place_m = map.grid.low_m + kTexel_m * glm::dvec2(x + 0.5, y + 0.5);
      double nearest_m = 1e9;
      for (const BorderLine& line : lines) {
        nearest_m = std::min(nearest_m, Distance_m(line, place_m));
      }
      const glm::vec4 texel =
          glm::unpackHalf4x16(map.nearest[static_cast<std::size_t>(100 * y + x)]);
      // Danielsson's transform misses the nearest point by a fraction of a texel, and half floats
      // have 11 bits.
      EXPECT_NEAR(texel.z, nearest_m / kTexel_m, 0.02) << x << ' ' << y;
      EXPECT_NEAR(glm::length(glm::vec2(texel)), texel.z, 1e-3F * (1.0F + texel.z));
    }
  }
}

// Halfway between two lines, the stored offsets to the nearest line have opposite directions, and
// interpolation makes them cancel.
TEST(BorderMapTest, NothingIsPaintedBetweenTwoLines) {
  for (const double apart_m : {1'250.0, 2'000.0, 11e3}) {
    const BorderLine south{{{-10e3, 0.0}, {40e3, 0.0}}, 1.0F};
    const BorderLine north{{{-10e3, apart_m}, {40e3, apart_m}}, 1.0F};
    const BorderMap map = MakeBorderMap({south, north}, Square(100));
    for (double y_m = 70.0; y_m < apart_m - 65.0; y_m += 7.0) {
      EXPECT_EQ(PaintedAt(map, {12'345.0, y_m}), 0.0F) << apart_m << ' ' << y_m;
    }
  }
}

TEST(BorderMapTest, LinesHaveTheirStrengthAndVanishTowardsTheEdge) {
  const BorderLine line{{{-10e3, 5e3}, {40e3, 5e3}}, 0.6F};
  const BorderMap map = MakeBorderMap({line}, Square(100, 10e3));
  EXPECT_NEAR(PaintedAt(map, {15e3, 5e3}), 0.6F, 1e-3F);
  EXPECT_NEAR(PaintedAt(map, {-4'750.0, 5e3}), 0.3F, 0.01F);
  EXPECT_NEAR(PaintedAt(map, {35e3, 5e3}), 0.3F, 0.02F);
  EXPECT_EQ(PaintedAt(map, {-10e3, 5e3}), 0.0F);
  EXPECT_EQ(PaintedAt(map, {400e3, 5e3}), 0.0F);
}

TEST(BorderMapTest, WithoutLinesThereItIsEmpty) {
  const BorderLine far{{{500e3, 0.0}, {600e3, 0.0}}, 1.0F};
  EXPECT_TRUE(MakeBorderMap({}, Square(10)).nearest.empty());
  EXPECT_TRUE(MakeBorderMap({far}, Square(10)).nearest.empty());
  EXPECT_EQ(MakeBorderMap({far}, Square(10)).Bytes(), 0U);
}

}  // namespace
}  // namespace thunderhead::volume
