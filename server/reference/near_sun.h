// Where a drawn picture cannot be compared with the reference: next to the sun.
#pragma once

#include <vector>

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "reference/camera.h"

namespace thunderhead::reference {

// For each pixel, rows from top to bottom, whether any of it looks at the sun's disc or nearer to
// the sun than `peak_cut_deg` (MediumOptions::peak_cut_deg). The disc is drawn apart, and so much
// brighter than all else that a difference at its edge hides all others; around it renderers show
// the aureole, up to a thousand times brighter than the storm, which the reference's cut leaves
// out.
std::vector<bool> NearSun(const Camera& camera, const glm::dvec3& towards_sun,
                          const glm::ivec2& size_px, double peak_cut_deg);

// Share of a picture's pixels that must be away from the sun for the rest to stand for it.
inline constexpr double kLeastAwayFromSun = 0.1;

}  // namespace thunderhead::reference
