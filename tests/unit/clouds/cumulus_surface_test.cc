#include "clouds/cumulus_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "clouds/cauliflower.h"
#include "clouds/inscribed_balls.h"
#include "clouds/presets.h"
#include "glm/geometric.hpp"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::clouds {
namespace {

using testing::HasSubstr;

volume::RegularGrid Cube(int cells, double spacing_m) {
  volume::RegularGrid grid;
  grid.cells = glm::ivec3(cells);
  grid.spacing_m = glm::dvec3(spacing_m);
  grid.low_corner_m = glm::dvec3(-0.5 * cells * spacing_m);
  return grid;
}

template <typename Inside>
std::vector<float> Filled(const volume::RegularGrid& grid, const Inside& inside) {
  std::vector<float> values(grid.CellCount(), 0.0F);
  for (int z = 0; z < grid.cells.z; ++z) {
    for (int y = 0; y < grid.cells.y; ++y) {
      for (int x = 0; x < grid.cells.x; ++x) {
        const glm::dvec3 middle_m =
            grid.low_corner_m + (glm::dvec3(x, y, z) + 0.5) * grid.spacing_m;
        if (inside(middle_m)) values[grid.Offset(x, y, z)] = 1.0F;
      }
    }
  }
  return values;
}

TEST(Cauliflower, IsTheSameForASeed) {
  const auto first = Cauliflower({3, 3});
  const auto again = Cauliflower({3, 3});
  const auto other = Cauliflower({4, 3});
  ASSERT_TRUE(first.ok() && again.ok() && other.ok());
  ASSERT_EQ(first->bubbles.size(), again->bubbles.size());
  bool differs = first->bubbles.size() != other->bubbles.size();
  for (std::size_t i = 0; i < first->bubbles.size(); ++i) {
    ASSERT_EQ(first->bubbles[i].centre_m, again->bubbles[i].centre_m);
    differs = differs || first->bubbles[i].centre_m != other->bubbles[i].centre_m;
  }
  EXPECT_TRUE(differs);
}

TEST(Cauliflower, BubblesLieOnTheirParents) {
  const auto surface = Cauliflower({1, 3});
  ASSERT_TRUE(surface.ok());
  int with_grandparent = 0;
  for (std::size_t i = 0; i < surface->bubbles.size(); ++i) {
    const Bubble& bubble = surface->bubbles[i];
    ASSERT_LT(bubble.parent, static_cast<int>(i));
    ASSERT_NEAR(glm::length(bubble.outward), 1.0, 1e-9);
    if (bubble.parent < 0) continue;
    const Bubble& parent = surface->bubbles[static_cast<std::size_t>(bubble.parent)];
    ASSERT_GT(RadiusOf(parent), RadiusOf(bubble));
    const double depth = glm::length(UnitFromWorld(parent) * (bubble.centre_m - parent.centre_m));
    ASSERT_GT(depth, 0.3);
    ASSERT_LT(depth, 1.7);
    with_grandparent += parent.parent >= 0 ? 1 : 0;
  }
  EXPECT_GT(with_grandparent, 100);
}

TEST(Cauliflower, MoreScalesAreFiner) {
  double finest_m = std::numeric_limits<double>::infinity();
  std::size_t bubbles = 0;
  for (int scales = 1; scales <= 4; ++scales) {
    const auto surface = Cauliflower({1, scales});
    ASSERT_TRUE(surface.ok());
    EXPECT_GT(surface->bubbles.size(), bubbles);
    EXPECT_LT(surface->finest_m, finest_m);
    bubbles = surface->bubbles.size();
    finest_m = surface->finest_m;
  }
}

TEST(LoneEllipsoid, IsOneAndBubblesOnIt) {
  const auto bare = LoneEllipsoid({1, 1});
  ASSERT_TRUE(bare.ok()) << bare.status();
  EXPECT_EQ(bare->bubbles.size(), 1U);
  EXPECT_DOUBLE_EQ(bare->finest_m, RadiusOf(bare->bubbles[0]));
  const auto bubbly = LoneEllipsoid({1, 2});
  ASSERT_TRUE(bubbly.ok()) << bubbly.status();
  EXPECT_GT(bubbly->bubbles.size(), 20U);
  for (std::size_t i = 1; i < bubbly->bubbles.size(); ++i) {
    EXPECT_EQ(bubbly->bubbles[i].parent, 0);
  }
  EXPECT_FALSE(LoneEllipsoid({1, 0}).ok());
}

TEST(Cauliflower, RefusesNoScalesAndTooMany) {
  for (const int scales : {-1, 0, kMaxScales + 1}) {
    const auto surface = Cauliflower({1, scales});
    ASSERT_FALSE(surface.ok());
    EXPECT_EQ(surface.status().code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(std::string(surface.status().message()), HasSubstr("must be from 1 to 5"));
    EXPECT_FALSE(SurfaceOfPreset("congestus", {1, scales}).ok());
  }
}

TEST(SurfaceOfPreset, KeepsThePresetsEllipsoids) {
  for (const std::string& name : PresetNames()) {
    const auto shape = PresetNamed(name, 5);
    const auto surface = SurfaceOfPreset(name, {5, 1});
    ASSERT_TRUE(surface.ok());
    EXPECT_EQ(surface->bubbles.size(), shape->ellipsoids.size());
    EXPECT_EQ(surface->base_m, shape->base_m);
    double volume_m3 = 0.0;
    for (const Bubble& bubble : surface->bubbles) volume_m3 += std::pow(RadiusOf(bubble), 3.0);
    double expected_m3 = 0.0;
    for (const Ellipsoid& one : shape->ellipsoids) {
      expected_m3 += one.radii_m.x * one.radii_m.y * one.radii_m.z;
    }
    EXPECT_NEAR(volume_m3, expected_m3, 1e-9 * expected_m3);
  }
  EXPECT_EQ(SurfaceOfPreset("nimbus", {}).status().code(), absl::StatusCode::kInvalidArgument);
}

TEST(FitInto, StandsOnTheFloorAndTouchesTheNearestWalls) {
  auto surface = Cauliflower({1, 2});
  ASSERT_TRUE(surface.ok());
  const SurfaceBox box{{1000.0, 0.0, 500.0}, {3000.0, 1000.0, 9000.0}};
  FitInto(box, &*surface);
  const SurfaceBox got = BoxOf(*surface);
  EXPECT_NEAR(got.low_m.z, 500.0, 1e-6);
  EXPECT_NEAR(*surface->base_m, 500.0, 1e-6);
  EXPECT_NEAR(got.low_m.y, 0.0, 1e-6);
  EXPECT_NEAR(got.high_m.y, 1000.0, 1e-6);
  EXPECT_NEAR((got.low_m.x + got.high_m.x) / 2.0, 2000.0, 1e-6);
}

TEST(DistanceInside, IsThatOfEveryPair) {
  volume::RegularGrid grid = Cube(9, 10.0);
  grid.spacing_m.z = 4.0;
  const std::vector<float> values = Filled(grid, [](const glm::dvec3& p) {
    return std::abs(p.x) < 32.0 && std::abs(p.y - 5.0) < 25.0 && p.x + p.y + 3.0 * p.z < 60.0;
  });
  const std::vector<float> distance_m = DistanceInside_m(grid, values, 0.5F);
  const auto value = [&](const glm::ivec3& cell) {
    const bool inside = glm::all(glm::greaterThanEqual(cell, glm::ivec3(0))) &&
                        glm::all(glm::lessThan(cell, grid.cells));
    return inside ? values[grid.Offset(cell.x, cell.y, cell.z)] : 0.0F;
  };
  const auto for_each = [&](int margin, const auto& visit) {
    for (int z = -margin; z < grid.cells.z + margin; ++z) {
      for (int y = -margin; y < grid.cells.y + margin; ++y) {
        for (int x = -margin; x < grid.cells.x + margin; ++x) visit(glm::ivec3(x, y, z));
      }
    }
  };
  for_each(0, [&](const glm::ivec3& cell) {
    double nearest_m = value(cell) > 0.5F ? 1e9 : 0.0;
    if (nearest_m > 0.0) {
      for_each(1, [&](const glm::ivec3& other) {
        if (value(other) > 0.5F) return;
        nearest_m = std::min(nearest_m, glm::length(glm::dvec3(other - cell) * grid.spacing_m));
      });
    }
    ASSERT_NEAR(distance_m[grid.Offset(cell.x, cell.y, cell.z)], nearest_m, 1e-3);
  });
}

TEST(InscribedBalls, ABallIsFoundFirstAndWhole) {
  const volume::RegularGrid grid = Cube(41, 50.0);
  const auto values = Filled(grid, [](const glm::dvec3& p) { return glm::length(p) < 700.0; });
  const CumulusSurface surface = InscribedBalls(grid, values, {.level = 0.5F});
  ASSERT_FALSE(surface.Empty());
  EXPECT_LT(glm::length(surface.bubbles.front().centre_m), 1.0);
  EXPECT_NEAR(RadiusOf(surface.bubbles.front()), 700.0, 50.0);
}

TEST(InscribedBalls, ALayerIsOfFlatOnes) {
  volume::RegularGrid grid = Cube(48, 100.0);
  const auto values = Filled(grid, [](const glm::dvec3& p) { return std::abs(p.z) < 450.0; });
  const CumulusSurface surface = InscribedBalls(grid, values, {.level = 0.5F});
  ASSERT_FALSE(surface.Empty());
  const Bubble& first = surface.bubbles.front();
  EXPECT_NEAR(first.semi_axes_m[0][0] / first.semi_axes_m[2][2], 3.0, 0.01);
  // There are eight cells, so the cloud's middle lies between two of them.
  EXPECT_NEAR(first.semi_axes_m[2][2], 400.0, 51.0);
}

TEST(Sprout, KeepsToTheLimitAndSpreadsTheBubbles) {
  constexpr int kParents = 12;
  CumulusSurface lonely;
  for (int i = 0; i < kParents; ++i)
    lonely.bubbles.push_back(BallOf({1000.0 * i, 0.0, 0.0}, 100.0));
  LayOnLarger(&lonely);
  for (const int room : {0, 1, 4, 11, 12, 30}) {
    CumulusSurface surface = lonely;
    Sprouting sprouting;
    sprouting.max_bubbles = kParents + room;
    Sprout(sprouting, 0, &surface);
    std::vector<int> children(kParents, 0);
    for (std::size_t i = kParents; i < surface.bubbles.size(); ++i) {
      ++children[static_cast<std::size_t>(surface.bubbles[i].parent)];
    }
    const int sum = static_cast<int>(surface.bubbles.size()) - kParents;
    EXPECT_EQ(sum, room < kParents ? room : room / kParents * kParents) << room;
    const auto half = std::accumulate(children.begin(), children.begin() + kParents / 2, 0);
    EXPECT_NEAR(half, sum / 2.0, 0.5) << room << ": both halves get equally many";
  }
}

TEST(InscribedBalls, StayInsideAndCoverWhatIsThere) {
  const volume::RegularGrid grid = Cube(40, 100.0);
  const auto inside = [](const glm::dvec3& p) {
    return glm::length(p) < 1200.0 || glm::length(p - glm::dvec3(1200.0, 300.0, 500.0)) < 500.0;
  };
  const auto values = Filled(grid, inside);
  const CumulusSurface surface = InscribedBalls(grid, values, {.level = 0.5F, .max_balls = 5000});
  const auto middle = [&](const glm::ivec3& cell) {
    return grid.low_corner_m + (glm::dvec3(cell) + 0.5) * grid.spacing_m;
  };
  std::vector<bool> is_covered(grid.CellCount(), false);
  for (const Bubble& bubble : surface.bubbles) {
    const auto unit_from_world = UnitFromWorld(bubble);
    double reach_m = 0.0;
    for (int axis = 0; axis < 3; ++axis) reach_m += glm::length(bubble.semi_axes_m[axis]);
    const glm::dvec3 from = (bubble.centre_m - reach_m - grid.low_corner_m) / grid.spacing_m;
    const glm::dvec3 to = (bubble.centre_m + reach_m - grid.low_corner_m) / grid.spacing_m;
    const glm::ivec3 low(glm::clamp(from, 0.0, 39.0));
    const glm::ivec3 high(glm::clamp(to, 0.0, 39.0));
    for (int z = low.z; z <= high.z; ++z) {
      for (int y = low.y; y <= high.y; ++y) {
        for (int x = low.x; x <= high.x; ++x) {
          const glm::dvec3 apart_m = middle({x, y, z}) - bubble.centre_m;
          if (glm::length(unit_from_world * apart_m) < 1.0) is_covered[grid.Offset(x, y, z)] = true;
        }
      }
    }
  }
  int missed = 0;
  int outside = 0;
  int cells = 0;
  for (int z = 0; z < 40; ++z) {
    for (int y = 0; y < 40; ++y) {
      for (int x = 0; x < 40; ++x) {
        const glm::dvec3 p = middle({x, y, z});
        const bool covered = is_covered[grid.Offset(x, y, z)];
        cells += inside(p) ? 1 : 0;
        missed += inside(p) && !covered ? 1 : 0;
        outside += !inside(p) && covered ? 1 : 0;
      }
    }
  }
  EXPECT_EQ(missed, 0);
  // Balls are never smaller than a cell.
  EXPECT_LT(outside, cells / 20);
}

TEST(InscribedBalls, OfNothingThereAreNone) {
  const volume::RegularGrid grid = Cube(8, 100.0);
  const std::vector<float> values(grid.CellCount(), 0.1F);
  EXPECT_TRUE(InscribedBalls(grid, values, {.level = 0.1F}).Empty());
}

}  // namespace
}  // namespace thunderhead::clouds
