// Divides an extinction volume into bricks and marks the empty ones, so that rays can skip them.
// The faces of bricks lie at cell centres. This code also lists the blocks of cells that a ray can
// sample. This code does not depend on GL.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "glm/vec3.hpp"
#include "volume/extinction.h"

namespace thunderhead::volume {

// A map of bricks. Along each axis, brick i reaches from the centre of cell n i - 1 to the centre
// of cell n (i + 1) - 1, where n is cells_per_brick. Linear interpolation inside brick i reads only
// cells n i - 1 to n (i + 1) - 1. At the volume's ends some of these cells do not exist.
struct BrickMap {
  glm::ivec3 cells_per_brick{1};
  glm::ivec3 bricks{0};
  // The content of each brick, x fastest: kThick or kThin for a brick that is not empty, and a
  // distance for an empty brick. That distance is the Chebyshev distance, in bricks, to the nearest
  // brick that is not empty. It is 1 to any of a brick's 26 neighbours, and at most 254.
  std::vector<std::uint8_t> content;

  static constexpr std::uint8_t kThick = 0;
  // A brick that is not empty but thin: the optical depth along its diagonal is at most
  // kThinOpticalDepth.
  static constexpr std::uint8_t kThin = 255;
  static constexpr double kThinOpticalDepth = 0.05;

  static bool IsEmpty(std::uint8_t content) { return content != kThick && content != kThin; }
};

// Returns the bricks of `volume`, roughly cubic in metres, at most 1024 along an axis. The function
// reads the texels of the volume's planes, so they must still be in memory.
BrickMap BrickMapOf(const ExtinctionVolume& volume);

// The occupied cubes of a brick map: cubes with at least one brick that is not empty. Each is
// encoded as x + 1024 (y + 1024 z), counted in cubes.
struct BrickCubes {
  int bricks_across = 1;  // edge length of a cube in bricks; a power of two
  std::vector<std::uint32_t> occupied;
};

// Returns the occupied cubes of the smallest cube size at which there are at most `max_cubes` of
// them. `max_cubes` must be at least 1.
BrickCubes OccupiedCubesOf(const BrickMap& map, std::size_t max_cubes);

// Blocks of cells, roughly cubic in metres. Block i begins at cell i * cells_per_block.
struct CellBlocks {
  static constexpr std::uint32_t kThick = 1U << 31U;

  glm::ivec3 cells_per_block{1};
  // The blocks with a cell that interpolation in an occupied brick reads. Each is encoded as x +
  // 1024 (y + 1024 z), plus the bit kThick if one of those bricks is thick.
  std::vector<std::uint32_t> occupied;
};

CellBlocks CellBlocksOf(const BrickMap& map, const RegularGrid& grid);

}  // namespace thunderhead::volume
