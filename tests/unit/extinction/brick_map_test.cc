#include "volume/brick_map.h"

#include <cstdlib>
#include <map>

#include "base/half_float.h"
#include "glm/common.hpp"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "volume/extinction.h"

namespace thunderhead::volume {
namespace {

// A cell with extinction, for VolumeWith().
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
        base::HalfFromFloat(fill.extinction_per_m / volume.extinction_per_m);
  }
  volume.planes.push_back(std::move(plane));
  return volume;
}

int ContentAt(const BrickMap& map, int x, int y, int z) {
  return map.content[static_cast<std::size_t>((z * map.bricks.y + y) * map.bricks.x + x)];
}

TEST(BrickMap, BricksAreAboutCubes) {
  const ExtinctionVolume volume = VolumeWith({10, 12, 9}, {});
  const BrickMap map = BrickMapOf(volume);
  EXPECT_EQ(map.cells_per_brick, glm::ivec3(1, 1, 2));
  // The grid has one brick before the first cell's centre and one behind the last one's.
  EXPECT_EQ(map.bricks, glm::ivec3(11, 13, 5));
  EXPECT_TRUE(OccupiedCubesOf(map, 8).occupied.empty());
  const CellBlocks blocks = CellBlocksOf(map, volume.grid);
  EXPECT_EQ(blocks.cells_per_block, glm::ivec3(4, 4, 8));
  EXPECT_TRUE(blocks.occupied.empty());
}

TEST(BrickMap, ACellFillsEveryBrickThatInterpolationReaches) {
  // Cell (4, 5, 2) meets bricks 4 and 5 in x, and 5 and 6 in y. In z it meets only brick 1, which
  // reaches from the centre of cell 1 to that of cell 3.
  const BrickMap map = BrickMapOf(VolumeWith({20, 20, 20}, {{{4, 5, 2}, 0.1F}}));
  constexpr std::uint32_t kLayer = 1024 * 1024;
  EXPECT_THAT(OccupiedCubesOf(map, 8).occupied,
              testing::ElementsAre(kLayer + 1024 * 5 + 4, kLayer + 1024 * 5 + 5,
                                   kLayer + 1024 * 6 + 4, kLayer + 1024 * 6 + 5));
  for (const int x : {4, 5}) {
    for (const int y : {5, 6}) EXPECT_EQ(ContentAt(map, x, y, 1), BrickMap::kThick);
  }
}

TEST(BrickMap, BricksAreFilledWhereInterpolationIsNotZeroAndNowhereElse) {
  // One cell is inside, one is in the first corner, and one is in the last corner. The number of
  // cells is odd along x, and even along y and z.
  const ExtinctionVolume volume =
      VolumeWith({9, 8, 12}, {{{4, 5, 6}, 0.1F}, {{0, 0, 0}, 0.1F}, {{8, 7, 11}, 0.1F}});
  const BrickMap map = BrickMapOf(volume);
  const auto at = [&](glm::ivec3 cell) {
    cell = glm::clamp(cell, glm::ivec3(0), volume.grid.cells - 1);
    return volume.planes[0].texels[2 * volume.grid.Offset(cell.x, cell.y, cell.z) + 1] > 0;
  };
  for (int z = 0; z < map.bricks.z; ++z) {
    for (int y = 0; y < map.bricks.y; ++y) {
      for (int x = 0; x < map.bricks.x; ++x) {
        const glm::ivec3 end = glm::ivec3(x + 1, y + 1, z + 1) * map.cells_per_brick - 1;
        bool met = false;
        for (int k = end.z - map.cells_per_brick.z; k <= end.z; ++k) {
          for (const int j : {end.y - 1, end.y})
            met = met || at({end.x, j, k}) || at({end.x - 1, j, k});
        }
        EXPECT_EQ(ContentAt(map, x, y, z) == BrickMap::kThick, met) << x << ' ' << y << ' ' << z;
      }
    }
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
  EXPECT_EQ(ContentAt(map, 5, 5, 3), BrickMap::kThin);
  EXPECT_EQ(ContentAt(map, 5, 31, 3), BrickMap::kThick);
  EXPECT_GT(ContentAt(map, 31, 31, 15), 0);
  EXPECT_LT(ContentAt(map, 31, 31, 15), 255);
}

TEST(BrickMap, ThickStaysThickBesideThin) {
  const BrickMap map =
      BrickMapOf(VolumeWith({40, 40, 40}, {{{5, 5, 5}, 0.01F}, {{4, 5, 5}, 1e-6F}}));
  EXPECT_EQ(ContentAt(map, 5, 5, 3), BrickMap::kThick);  // the brick meets both cells
  EXPECT_EQ(ContentAt(map, 4, 5, 3),
            BrickMap::kThin);  // the brick ends at the thin cell's centre
}

TEST(BrickMap, TakesTheMostOfAllChannelsOfAllPlanes) {
  // Five channels are stored in two planes, which have four channels and one channel.
  ExtinctionVolume volume = VolumeWith({8, 8, 8}, {});
  volume.planes.clear();
  for (const int channels : {4, 1}) {
    ExtinctionPlane plane;
    plane.channels = channels;
    plane.texels.assign(static_cast<std::size_t>(channels) * volume.grid.CellCount(), 0);
    volume.planes.push_back(std::move(plane));
  }
  volume.planes[0].texels[4 * volume.grid.Offset(2, 2, 2) + 3] = base::HalfFromFloat(100.0F);
  volume.planes[1].texels[volume.grid.Offset(6, 6, 6)] = base::HalfFromFloat(1e-3F);
  const BrickMap map = BrickMapOf(volume);
  EXPECT_EQ(ContentAt(map, 2, 2, 1), BrickMap::kThick);
  EXPECT_EQ(ContentAt(map, 6, 6, 3), BrickMap::kThin);
  EXPECT_EQ(ContentAt(map, 4, 4, 2), 1);
}

TEST(BrickMap, AtMost1024AlongAnAxis) {
  for (const int cells : {1023, 1024, 2048, 16384}) {
    const ExtinctionVolume volume = VolumeWith({cells, 1, 1}, {{{cells - 1, 0, 0}, 0.1F}});
    const BrickMap map = BrickMapOf(volume);
    EXPECT_LE(map.bricks.x, 1024) << cells;
    EXPECT_EQ(ContentAt(map, map.bricks.x - 1, 0, 0), BrickMap::kThick) << cells;
    const CellBlocks blocks = CellBlocksOf(map, volume.grid);
    EXPECT_LE((cells - 1) / blocks.cells_per_block.x, 1023) << cells;
    EXPECT_EQ(
        blocks.occupied.back(),
        CellBlocks::kThick + static_cast<std::uint32_t>((cells - 1) / blocks.cells_per_block.x));
  }
}

TEST(BrickCubes, GrowUntilThereAreFewEnough) {
  // Three cells fill 4 bricks each, at both ends of x, and one of them at the end of y too.
  const BrickMap map = BrickMapOf(
      VolumeWith({20, 20, 20}, {{{2, 2, 2}, 0.1F}, {{17, 2, 2}, 1e-6F}, {{17, 17, 2}, 0.1F}}));
  EXPECT_EQ(OccupiedCubesOf(map, 12).bricks_across, 1);
  EXPECT_EQ(OccupiedCubesOf(map, 12).occupied.size(), 12U);
  // Along x these are bricks 2 and 3, 17 and 18.
  const BrickCubes cubes = OccupiedCubesOf(map, 11);
  EXPECT_EQ(cubes.bricks_across, 2);
  EXPECT_THAT(cubes.occupied,
              testing::ElementsAre(1 + 1024 * 1, 8 + 1024 * 1, 9 + 1024 * 1, 8 + 1024 * 8,
                                   9 + 1024 * 8, 8 + 1024 * 9, 9 + 1024 * 9));
  EXPECT_EQ(OccupiedCubesOf(map, 1).bricks_across, 32);
  EXPECT_THAT(OccupiedCubesOf(map, 1).occupied, testing::ElementsAre(0));
}

TEST(CellBlocks, HoldEveryCellThatIsMetInAnOccupiedBrick) {
  const ExtinctionVolume volume = VolumeWith(
      {21, 20, 22},
      {{{5, 6, 7}, 0.1F}, {{6, 6, 7}, 1e-6F}, {{20, 0, 21}, 1e-6F}, {{13, 13, 4}, 0.1F}});
  const BrickMap map = BrickMapOf(volume);
  const CellBlocks blocks = CellBlocksOf(map, volume.grid);
  std::map<std::uint32_t, bool> expected;  // by brick: whether the brick is thick
  for (int z = 0; z < map.bricks.z; ++z) {
    for (int y = 0; y < map.bricks.y; ++y) {
      for (int x = 0; x < map.bricks.x; ++x) {
        const int content = ContentAt(map, x, y, z);
        if (content != BrickMap::kThick && content != BrickMap::kThin) continue;
        const glm::ivec3 last = glm::min(glm::ivec3(x + 1, y + 1, z + 1) * map.cells_per_brick - 1,
                                         volume.grid.cells - 1);
        const glm::ivec3 first =
            glm::max(glm::ivec3(x, y, z) * map.cells_per_brick - 1, glm::ivec3(0));
        for (int k = first.z; k <= last.z; ++k) {
          for (int j = first.y; j <= last.y; ++j) {
            for (int i = first.x; i <= last.x; ++i) {
              const glm::ivec3 block = glm::ivec3(i, j, k) / blocks.cells_per_block;
              expected[static_cast<std::uint32_t>(block.x + 1024 * (block.y + 1024 * block.z))] |=
                  content == BrickMap::kThick;
            }
          }
        }
      }
    }
  }
  std::vector<std::uint32_t> packed;
  for (const auto& [block, thick] : expected) {
    packed.push_back(block | (thick ? CellBlocks::kThick : 0U));
  }
  EXPECT_EQ(blocks.occupied, packed);
}

}  // namespace
}  // namespace thunderhead::volume
