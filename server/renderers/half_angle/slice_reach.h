// Bounds of each slice: where the occupied bricks that it cuts lie in the picture and in the
// light buffer. Pure geometry: no GL.
#pragma once

#include <vector>

#include "renderers/cover.h"
#include "renderers/half_angle/slicing.h"

namespace thunderhead::renderers {

// Both are empty for a slice that meets nothing.
struct SliceReach {
  PixelRect eye;
  PixelRect light;  // texels, with one around
};

// One for each slice. `boxes` are around `middle_m`, the origin of the slices' coordinates.
std::vector<SliceReach> ReachOf(const Slicing& slicing, const Boxes& boxes,
                                const glm::dvec3& middle_m, const scene::View& view,
                                const glm::ivec2& eye_px, const LightFrame& frame,
                                const glm::ivec2& light_texels);

}  // namespace thunderhead::renderers
