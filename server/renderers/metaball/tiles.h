// The balls that may lie over each tile of a picture, the nearest to the eye first. The lists
// replace sorting and blending the balls one by one. It is pure geometry without GL.
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
  std::vector<std::uint32_t>
      starts;  // start of each tile in `balls`, row by row from the bottom, and the end
  std::vector<std::uint32_t> balls;
};

// Returns the lists, with tiles as small as the limit on the lists' length allows.
BallTiles TilesOf(const std::vector<Ball>& balls, const scene::View& view,
                  const glm::ivec2& size_px);

}  // namespace thunderhead::renderers
