// Marks the empty parts of an extinction volume, in bricks between its cells' centres, so that rays
// can skip them. It also lists the cells that a ray may then sample. This code does not depend on
// GL.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "glm/vec3.hpp"
#include "volume/extinction.h"

namespace thunderhead::volume {

// A map of bricks. Along each axis, brick i reaches from the centre of cell n i - 1 to the centre
// of cell n (i + 1) - 1, where n is cells_per_brick. Linear interpolation inside the brick reads
// only these cells and those between them. At the volume's ends some of these cells do not exist.
struct BrickMap {
  glm::ivec3 cells_per_brick{1};
  glm::ivec3 bricks{0};
  // The content of each brick (x fastest): kThick, kThin or a distance. An empty brick has the
  // Chebyshev distance in bricks to the nearest brick that is not empty. The distance is 1 for any
  // of the 26 neighbours, and at most 254.
  std::vector<std::uint8_t> content;

  static constexpr std::uint8_t kThick = 0;
  // A brick that is not empty, but along whose longest path the optical depth is below
  // kThinOpticalDepth.
  static constexpr std::uint8_t kThin = 255;
  static constexpr double kThinOpticalDepth = 0.05;

  static bool IsEmpty(std::uint8_t content) { return content != kThick && content != kThin; }
};

// Returns the bricks of `volume`, roughly cubic in metres, at most 1024 along an axis. It reads the
// planes' texels, which must not have been freed.
BrickMap BrickMapOf(const ExtinctionVolume& volume);

// Cubes of bricks that are not empty, each encoded as x + 1024 (y + 1024 z).
struct BrickCubes {
  int bricks_across = 1;  // a power of two
  std::vector<std::uint32_t> occupied;
};

// Returns the smallest cubes such that there are at most `max_cubes` of them (1 or more).
BrickCubes OccupiedCubesOf(const BrickMap& map, std::size_t max_cubes);

// Blocks of cells, roughly cubic in metres. Block i begins at cell i * cells_per_block.
struct CellBlocks {
  static constexpr std::uint32_t kThick = 1U << 31U;

  glm::ivec3 cells_per_block{1};
  // The blocks with a cell that interpolation in an occupied brick reads. Each is encoded as x +
  // 1024 (y + 1024 z), with kThick set if that brick is thick.
  std::vector<std::uint32_t> occupied;
};

CellBlocks CellBlocksOf(const BrickMap& map, const RegularGrid& grid);

}  // namespace thunderhead::volume
