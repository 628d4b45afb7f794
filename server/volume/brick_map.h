// Which parts of an extinction volume are empty, in bricks between its cells' centres, so that a
// ray can leap over them; and which of its cells a ray may then meet. Knows no GL.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "glm/vec3.hpp"
#include "volume/extinction.h"

namespace thunderhead::volume {

// Brick i reaches, along each axis, from the centre of cell n i - 1 to that of cell n (i + 1) - 1,
// n being cells_per_brick: linear interpolation in it meets those cells and the ones between them,
// and no other. At the volume's ends some of them do not exist.
struct BrickMap {
  glm::ivec3 cells_per_brick{1};
  glm::ivec3 bricks{0};
  // For each brick (x fastest) what is in it: kThick, kThin, or for an empty one the Chebyshev
  // distance in bricks to the nearest that is not (1 if it is one of the 26 neighbours, at most
  // 254).
  std::vector<std::uint8_t> content;

  static constexpr std::uint8_t kThick = 0;
  // Not empty, but the way through the brick has an optical depth below kThinOpticalDepth.
  static constexpr std::uint8_t kThin = 255;
  static constexpr double kThinOpticalDepth = 0.05;

  static bool IsEmpty(std::uint8_t content) { return content != kThick && content != kThin; }
};

// The bricks of `volume`, about cubes in metres, at most 1024 along an axis. Takes the planes'
// texels, so before they are freed.
BrickMap BrickMapOf(const ExtinctionVolume& volume);

// Cubes of bricks with something in them, each as x + 1024 (y + 1024 z).
struct BrickCubes {
  int bricks_across = 1;  // a power of two
  std::vector<std::uint32_t> occupied;
};

// As small as can be for them to be at most `most`, which is at least 1.
BrickCubes OccupiedCubesOf(const BrickMap& map, std::size_t most);

// Cells in blocks, about cubes in metres. Block i begins with cell i * cells_per_block.
struct CellBlocks {
  static constexpr std::uint32_t kThick = 1U << 31U;

  glm::ivec3 cells_per_block{1};
  // Those with a cell that interpolation in an occupied brick meets, each as x + 1024 (y + 1024 z),
  // and kThick where it does in a thick one.
  std::vector<std::uint32_t> occupied;
};

CellBlocks CellBlocksOf(const BrickMap& map, const RegularGrid& grid);

}  // namespace thunderhead::volume
