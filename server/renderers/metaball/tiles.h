// For each tile of a picture, the list of balls that may cover it, nearest to the eye first. The
// lists replace sorting and blending the balls one by one. This code is pure geometry without GL.
#pragma once

#include <cstdint>
#include <vector>

#include "glm/vec2.hpp"
#include "renderers/metaball/ball_cloud.h"
#include "scene/view.h"

namespace thunderhead::renderers {

struct BallTiles {
  int tile_px = 16;
  glm::ivec2 tiles{1};
  // Index in `balls` at which each tile's list starts, row by row from the bottom, followed by the
  // size of `balls`.
  std::vector<std::uint32_t> starts;
  std::vector<std::uint32_t> balls;
};

// Returns the lists. Their total length is limited, and the tiles are as small as this limit
// allows.
BallTiles TilesOf(const std::vector<Ball>& balls, const scene::View& view,
                  const glm::ivec2& size_px);

}  // namespace thunderhead::renderers
