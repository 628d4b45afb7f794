// The plane perpendicular to a light's direction, with the rectangle in it that contains the shadow
// of a box. Light buffers, shadow maps and light volumes are laid out in this plane. This code is
// pure geometry without GL.
#pragma once

#include <array>

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"

namespace thunderhead::renderers {

// A box centred at the origin of local coordinates, in metres.
struct LocalBox {
  glm::dvec3 half_m{0.0};
};

std::array<glm::dvec3, 8> CornersOf(const LocalBox& box);

// A frame whose axes are perpendicular to the light and do not depend on the view.
struct LightFrame {
  glm::dvec3 towards_sun{0.0, 0.0, 1.0};
  glm::dvec3 right{1.0, 0.0, 0.0};
  glm::dvec3 up{0.0, 1.0, 0.0};
  glm::dvec2 half_extent_m{1.0};  // half the size of the rectangle that contains the box's shadow
  double half_depth_m = 1.0;      // half the extent of the box along the light
};

LightFrame LightFrameOf(const LocalBox& box, const glm::dvec3& towards_sun);

}  // namespace thunderhead::renderers
