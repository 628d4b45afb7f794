// The plane perpendicular to a light's direction that covers the shadow of a box. Light buffers,
// shadow maps and light volumes are laid out in it. It is pure geometry without GL.
#pragma once

#include <array>

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"

namespace thunderhead::renderers {

// A box around the origin of local coordinates (metres).
struct LocalBox {
  glm::dvec3 half_m{0.0};
};

std::array<glm::dvec3, 8> CornersOf(const LocalBox& box);

// A frame whose axes are perpendicular to the light and do not depend on the view.
struct LightFrame {
  glm::dvec3 towards_sun{0.0, 0.0, 1.0};
  glm::dvec3 right{1.0, 0.0, 0.0};
  glm::dvec3 up{0.0, 1.0, 0.0};
  glm::dvec2 half_extent_m{1.0};  // covers the box's shadow
  double half_depth_m = 1.0;      // of the box along the light
};

LightFrame LightFrameOf(const LocalBox& box, const glm::dvec3& towards_sun);

}  // namespace thunderhead::renderers
