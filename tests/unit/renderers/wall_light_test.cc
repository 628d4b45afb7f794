// Tests of which walls see each other, against view factors in closed form.
#include "renderers/light_volume/wall_light.h"

#include <algorithm>
#include <cmath>

#include "gtest/gtest.h"

namespace thunderhead::renderers {
namespace {

constexpr int kLong = 81;
constexpr int kGap = 6;
constexpr int kHigh = 12;
constexpr int kThick = 3;

DiffusionCells Empty(const glm::ivec3& size) {
  DiffusionCells cells;
  cells.size = size;
  cells.cell_m = glm::dvec3(100.0);
  cells.light_per_m.assign(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
                               static_cast<std::size_t>(size.z),
                           0.0F);
  cells.transport_per_m = cells.absorption_per_m = cells.light_per_m;
  return cells;
}

// Returns two long walls. The gap between them has the extinction `gap_per_m`.
DiffusionCells Canyon(float gap_per_m) {
  DiffusionCells cells = Empty({2 * kThick + kGap, kLong, kHigh});
  for (std::size_t i = 0; i < cells.transport_per_m.size(); ++i) {
    const int x = cells.CellAt(i).x;
    const bool wall = x < kThick || x >= kThick + kGap;
    cells.transport_per_m[i] = wall ? 1.0F : gap_per_m;
  }
  return cells;
}

std::size_t MiddleOfWall(const DiffusionCells& cells) {
  return cells.Offset({kThick - 1, kLong / 2, kHigh / 2});
}

TEST(WallLight, FacingWallsSeeTheirViewFactor) {
  const DiffusionCells cells = Canyon(0.0F);
  const WallLight walls(cells);
  double expected = 0.0;
  double hidden = 0.0;
  for (int z = 1; z + 1 < kHigh; ++z) {  // cells at the ends have one more face
    // From a point on one infinitely long wall, the view factor of the opposite wall is half the
    // sum of the sines of the angles to its two edges.
    const double up = std::atan2(kHigh - (z + 0.5), kGap);
    const double down = std::atan2(z + 0.5, kGap);
    expected += 0.5 * (std::sin(up) + std::sin(down));
    hidden += walls.Hidden()[cells.Offset({kThick - 1, kLong / 2, z})];
  }
  // Twelve rays represent all directions.
  EXPECT_NEAR(hidden / expected, 1.0, 0.1);
  EXPECT_EQ(walls.Hidden()[cells.Offset({0, kLong / 2, kHigh / 2})],
            0.0F);  // inside the wall
}

TEST(WallLight, WhatComesAndGoesBetweenWhiteWallsAddsUp) {
  const DiffusionCells cells = Canyon(0.0F);
  const WallLight walls(cells);
  std::vector<float> own(cells.transport_per_m.size(), 0.0F);
  own[MiddleOfWall(cells)] = 1.0F;
  std::vector<float> one(own.size(), 0.0F);
  walls.FindArriving(own, &one);
  std::fill(own.begin(), own.end(), 1.0F);
  std::vector<float> all(own.size(), 0.0F);
  walls.FindArriving(own, &all);
  const float seen = walls.Hidden()[MiddleOfWall(cells)];
  // All walls emit 1. A wall receives the fraction `seen` of this light, and also the light that
  // the walls reflect again and again.
  EXPECT_GT(all[MiddleOfWall(cells)], seen);
  EXPECT_LT(all[MiddleOfWall(cells)], seen / (1.0F - seen));
  EXPECT_GT(*std::max_element(one.begin(), one.end()), 0.0F);
  EXPECT_LT(one[MiddleOfWall(cells)], all[MiddleOfWall(cells)]);
}

TEST(WallLight, HazeBetweenWallsHidesThem) {
  const DiffusionCells clear = Canyon(0.0F);
  const DiffusionCells hazy = Canyon(1e-3F);
  const float seen = WallLight(clear).Hidden()[MiddleOfWall(clear)];
  const float through = WallLight(hazy).Hidden()[MiddleOfWall(hazy)];
  EXPECT_GT(through, 0.2F * seen);  // the longest paths are three gaps long
  EXPECT_LT(through, std::exp(-0.6F) * seen);
}

TEST(WallLight, LevelTopsAndSlopesOfStepsSeeNoWalls) {
  DiffusionCells level = Empty({20, 20, 12});
  DiffusionCells slope = level;
  for (std::size_t i = 0; i < level.transport_per_m.size(); ++i) {
    const glm::ivec3 cell = level.CellAt(i);
    level.transport_per_m[i] = cell.z < 5 ? 1.0F : 0.0F;
    slope.transport_per_m[i] = cell.z <= cell.x / 2 ? 1.0F : 0.0F;
  }
  const WallLight tops(level);
  for (const float hidden : tops.Hidden()) ASSERT_EQ(hidden, 0.0F);
  const WallLight walls(slope);
  EXPECT_LT(*std::max_element(walls.Hidden().begin(), walls.Hidden().end()), 0.15F);
}

// Returns ridges one cell wide and high, on a slope of one step in `run` cells, in a high domain.
DiffusionCells Ridges(float transport_per_m, int height, int run) {
  DiffusionCells cells = Empty({20, 20, 120});
  for (std::size_t i = 0; i < cells.transport_per_m.size(); ++i) {
    const glm::ivec3 cell = cells.CellAt(i);
    const int top = 5 + cell.x / run + height * (cell.x % 2);
    cells.transport_per_m[i] = cell.z <= top ? transport_per_m : 0.0F;
  }
  return cells;
}

float MostHidden(const DiffusionCells& cells) {
  const WallLight walls(cells);
  return *std::max_element(walls.Hidden().begin(), walls.Hidden().end());
}

// If the cells are only half a transport mean free path thick, light passes through them, and
// ridges of one cell count as the cloud's own shape. In denser cells they count as artefacts of the
// grid.
TEST(WallLight, RidgesOfOneCellSeeEachOtherWhereCellsAreThin) {
  const float thin = MostHidden(Ridges(0.005F, 1, 20));
  const float thick = MostHidden(Ridges(0.05F, 1, 20));
  EXPECT_GT(thin, thick + 0.2F);
  EXPECT_LT(thick, 0.2F);
  EXPECT_EQ(MostHidden(Ridges(0.005F, 0, 2)), MostHidden(Ridges(0.05F, 0, 2))) << "steps of slopes";
}

}  // namespace
}  // namespace thunderhead::renderers
