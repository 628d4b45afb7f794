// The pixels of a picture next to the sun, which cannot be compared with the path-traced reference.
#pragma once

#include <vector>

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "reference/camera.h"

namespace thunderhead::reference {

// Returns for each pixel, in rows from top to bottom, whether any part of it is too close to the
// sun to compare. These are pixels on the sun's disc, or nearer to the sun than `peak_cut_deg`
// (MediumOptions::peak_cut_deg). The disc is so bright that a difference at its edge would hide all
// other differences. Around the disc, renderers show the aureole, which is up to a thousand times
// brighter than the storm. The reference omits the aureole because it cuts the forward peak.
std::vector<bool> NearSun(const Camera& camera, const glm::dvec3& towards_sun,
                          const glm::ivec2& size_px, double peak_cut_deg);

// The smallest share of a picture's pixels that must be away from the sun, so that they represent
// the picture.
inline constexpr double kLeastAwayFromSun = 0.1;

}  // namespace thunderhead::reference
