// Which balls may lie over each tile of a picture, the nearest to the eye first: what splatting
// them one by one would sort by blending. Pure geometry: no GL.
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
      starts;  // of each tile in `balls`, row by row from the bottom; the end
  std::vector<std::uint32_t> balls;
};

// Tiles are as small as a list of bearable length allows.
BallTiles TilesOf(const std::vector<Ball>& balls, const scene::View& view,
                  const glm::ivec2& size_px);

}  // namespace thunderhead::renderers
