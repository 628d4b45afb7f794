#include "renderers/light_frame.h"

#include <cmath>

#include "glm/common.hpp"
#include "glm/geometric.hpp"

namespace thunderhead::renderers {
namespace {

// Returns two unit vectors that form a right-handed frame with `axis`.
std::array<glm::dvec3, 2> Across(const glm::dvec3& axis) {
  const glm::dvec3 other =
      std::abs(axis.z) < 0.9 ? glm::dvec3(0.0, 0.0, 1.0) : glm::dvec3(0.0, 1.0, 0.0);
  const glm::dvec3 right = glm::normalize(glm::cross(other, axis));
  return {right, glm::cross(axis, right)};
}

}  // namespace

std::array<glm::dvec3, 8> CornersOf(const LocalBox& box) {
  std::array<glm::dvec3, 8> corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 sign((i & 1U) != 0 ? 1.0 : -1.0, (i & 2U) != 0 ? 1.0 : -1.0,
                          (i & 4U) != 0 ? 1.0 : -1.0);
    corners[i] = sign * box.half_m;
  }
  return corners;
}

LightFrame LightFrameOf(const LocalBox& box, const glm::dvec3& towards_sun) {
  LightFrame frame;
  frame.towards_sun = towards_sun;
  const auto [right, up] = Across(towards_sun);
  frame.right = right;
  frame.up = up;
  frame.half_depth_m = glm::dot(glm::abs(towards_sun), box.half_m);
  frame.half_extent_m = glm::dvec2(0.0);
  for (const glm::dvec3& corner : CornersOf(box)) {
    frame.half_extent_m = glm::max(
        frame.half_extent_m, glm::abs(glm::dvec2(glm::dot(corner, right), glm::dot(corner, up))));
  }
  return frame;
}

}  // namespace thunderhead::renderers
