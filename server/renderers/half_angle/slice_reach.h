// Bounds of each slice in the picture and in the light buffer. They are the rectangles that the
// occupied bricks in the slice cover. This code is pure geometry without GL.
#pragma once

#include <vector>

#include "renderers/cover.h"
#include "renderers/half_angle/slicing.h"

namespace thunderhead::renderers {

// The bounds of one slice. Both rectangles are empty for a slice that meets no brick.
struct SliceReach {
  PixelRect eye;
  PixelRect light;  // in texels of the light buffer, with a border of one texel
};

// Returns the bounds of each slice. `boxes` are the occupied bricks. `middle_m` is the origin of
// the slices' coordinates.
std::vector<SliceReach> ReachOf(const Slicing& slicing, const Boxes& boxes,
                                const glm::dvec3& middle_m, const scene::View& view,
                                const glm::ivec2& eye_px, const LightFrame& frame,
                                const glm::ivec2& light_texels);

}  // namespace thunderhead::renderers
