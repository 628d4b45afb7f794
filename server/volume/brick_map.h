// Which parts of an extinction volume are empty, in bricks of cells, so that a ray can leap over
// them. Knows no GL.
#pragma once

#include <cstdint>
#include <vector>

#include "glm/vec3.hpp"
#include "volume/extinction.h"

namespace thunderhead::volume {

struct BrickMap {
  glm::ivec3 cells_per_brick{1};
  glm::ivec3 bricks{0};
  // For each brick (x fastest) what is in it: kThick, kThin, or for an empty one the Chebyshev
  // distance in bricks to the nearest that is not (1 if it is one of the 26 neighbours, at most
  // 254). What is in a brick is what linear interpolation anywhere in it may meet.
  std::vector<std::uint8_t> content;

  static constexpr std::uint8_t kThick = 0;
  // Not empty, but the way through the brick has an optical depth below kThinOpticalDepth.
  static constexpr std::uint8_t kThin = 255;
  static constexpr double kThinOpticalDepth = 0.1;

  // The bricks with something in them, each as x + 1024 (y + 1024 z).
  std::vector<std::uint32_t> Occupied() const;
};

// The bricks of `volume`, about cubes in metres, at most 1024 along an axis. Takes the planes'
// texels, so before they are freed.
BrickMap BrickMapOf(const ExtinctionVolume& volume);

}  // namespace thunderhead::volume
