#include "volume/brick_map.h"

#include <cstdlib>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "volume/extinction.h"

namespace thunderhead::volume {
namespace {

// A volume of `cells` with extinction only in the cells listed.
struct Filled {
  glm::ivec3 cell;
  float extinction_per_m;
};

ExtinctionVolume VolumeWith(const glm::ivec3& cells, const std::vector<Filled>& filled) {
  ExtinctionVolume volume;
  volume.grid.cells = cells;
  volume.grid.spacing_m = {1000.0, 1000.0, 500.0};
  volume.extinction_per_m = 1.0F / 1024;
  volume.negligible_per_m = 1e-8F;
  ExtinctionPlane plane;
  plane.channels = 2;
  plane.texels.assign(2 * volume.grid.CellCount(), 0);
  for (const Filled& fill : filled) {
    plane.texels[2 * volume.grid.Offset(fill.cell.x, fill.cell.y, fill.cell.z) + 1] =
        HalfFromFloat(fill.extinction_per_m / volume.extinction_per_m);
  }
  volume.planes.push_back(std::move(plane));
  return volume;
}

int ContentAt(const BrickMap& map, int x, int y, int z) {
  return map.content[static_cast<std::size_t>((z * map.bricks.y + y) * map.bricks.x + x)];
}

TEST(BrickMap, BricksAreAboutCubes) {
  const BrickMap map = BrickMapOf(VolumeWith({10, 12, 9}, {}));
  EXPECT_EQ(map.cells_per_brick, glm::ivec3(2, 2, 4));
  EXPECT_EQ(map.bricks, glm::ivec3(5, 6, 3));
  EXPECT_TRUE(map.Occupied().empty());
}

TEST(BrickMap, ACellFillsEveryBrickThatInterpolationReaches) {
  // Cell (4, 5, 0): its neighbours 3 and 5 lie in bricks 1 and 2 of x; 4 and 6 in 2 and 3 of y.
  const BrickMap map = BrickMapOf(VolumeWith({20, 20, 20}, {{{4, 5, 0}, 0.1F}}));
  EXPECT_THAT(map.Occupied(),
              testing::ElementsAre(1 + 1024 * 2, 2 + 1024 * 2, 1 + 1024 * 3, 2 + 1024 * 3));
  for (const int x : {1, 2}) {
    for (const int y : {2, 3}) EXPECT_EQ(ContentAt(map, x, y, 0), BrickMap::kThick);
  }
}

TEST(BrickMap, DistanceIsThatOfTheNearestOccupiedBrick) {
  const BrickMap map =
      BrickMapOf(VolumeWith({60, 40, 40}, {{{10, 11, 10}, 0.1F}, {{50, 3, 30}, 0.1F}}));
  std::vector<glm::ivec3> occupied;
  for (int z = 0; z < map.bricks.z; ++z) {
    for (int y = 0; y < map.bricks.y; ++y) {
      for (int x = 0; x < map.bricks.x; ++x) {
        if (ContentAt(map, x, y, z) == BrickMap::kThick) occupied.emplace_back(x, y, z);
      }
    }
  }
  ASSERT_FALSE(occupied.empty());
  for (int z = 0; z < map.bricks.z; ++z) {
    for (int y = 0; y < map.bricks.y; ++y) {
      for (int x = 0; x < map.bricks.x; ++x) {
        int nearest = 254;
        for (const glm::ivec3& other : occupied) {
          nearest = std::min(nearest, std::max({std::abs(other.x - x), std::abs(other.y - y),
                                                std::abs(other.z - z)}));
        }
        ASSERT_EQ(ContentAt(map, x, y, z), nearest) << x << ' ' << y << ' ' << z;
      }
    }
  }
}

TEST(BrickMap, ThinAndNegligibleCells) {
  const BrickMap map = BrickMapOf(
      VolumeWith({40, 40, 40}, {{{5, 5, 5}, 1e-6F}, {{31, 31, 31}, 1e-9F}, {{5, 31, 5}, 0.01F}}));
  EXPECT_EQ(ContentAt(map, 2, 2, 1), BrickMap::kThin);
  EXPECT_EQ(ContentAt(map, 2, 15, 1), BrickMap::kThick);
  EXPECT_GT(ContentAt(map, 15, 15, 7), 0);
  EXPECT_LT(ContentAt(map, 15, 15, 7), 255);
}

TEST(BrickMap, ThickStaysThickBesideThin) {
  const BrickMap map =
      BrickMapOf(VolumeWith({40, 40, 40}, {{{5, 5, 5}, 0.01F}, {{4, 5, 5}, 1e-6F}}));
  EXPECT_EQ(ContentAt(map, 2, 2, 1), BrickMap::kThick);
}

}  // namespace
}  // namespace thunderhead::volume
