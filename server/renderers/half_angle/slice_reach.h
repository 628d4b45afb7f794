// Bounds of each slice: the part of the picture and of the light buffer that the occupied bricks in
// the slice cover. It is pure geometry without GL.
#pragma once

#include <vector>

#include "renderers/cover.h"
#include "renderers/half_angle/slicing.h"

namespace thunderhead::renderers {

// Both rectangles are empty for a slice that meets no brick.
struct SliceReach {
  PixelRect eye;
  PixelRect light;  // in texels, with a border of one
};

// Returns the reach of each slice. `boxes` are around `middle_m`, the origin of the slices'
// coordinates.
std::vector<SliceReach> ReachOf(const Slicing& slicing, const Boxes& boxes,
                                const glm::dvec3& middle_m, const scene::View& view,
                                const glm::ivec2& eye_px, const LightFrame& frame,
                                const glm::ivec2& light_texels);

}  // namespace thunderhead::renderers
