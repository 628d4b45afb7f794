#include "renderers/half_angle/slicing.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "glm/common.hpp"
#include "glm/geometric.hpp"

namespace thunderhead::renderers {
namespace {

std::array<glm::dvec3, 8> Corners(const LocalBox& box) {
  std::array<glm::dvec3, 8> corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 sign((i & 1U) != 0 ? 1.0 : -1.0, (i & 2U) != 0 ? 1.0 : -1.0,
                          (i & 4U) != 0 ? 1.0 : -1.0);
    corners[i] = sign * box.half_m;
  }
  return corners;
}

// Two unit vectors that make a right-handed frame with `axis`.
std::array<glm::dvec3, 2> Across(const glm::dvec3& axis) {
  const glm::dvec3 other =
      std::abs(axis.z) < 0.9 ? glm::dvec3(0.0, 0.0, 1.0) : glm::dvec3(0.0, 1.0, 0.0);
  const glm::dvec3 right = glm::normalize(glm::cross(other, axis));
  return {right, glm::cross(axis, right)};
}

// Where the plane dot(normal, x) = distance cuts the box's edges, in order around the normal.
std::vector<glm::vec3> CutBox(const std::array<glm::dvec3, 8>& corners, const glm::dvec3& normal,
                              double distance_m) {
  std::vector<glm::dvec3> points;
  for (std::size_t i = 0; i < 8; ++i) {
    for (const std::size_t axis : {1U, 2U, 4U}) {
      const std::size_t j = i | axis;
      if (i == j) continue;
      const double a = glm::dot(normal, corners[i]) - distance_m;
      const double b = glm::dot(normal, corners[j]) - distance_m;
      if ((a < 0.0) == (b < 0.0)) continue;
      points.push_back(glm::mix(corners[i], corners[j], a / (a - b)));
    }
  }
  if (points.size() < 3) return {};
  glm::dvec3 middle(0.0);
  for (const glm::dvec3& point : points) middle += point / static_cast<double>(points.size());
  const auto [right, up] = Across(normal);
  const auto angle = [&, right = right, up = up](const glm::dvec3& point) {
    return std::atan2(glm::dot(point - middle, up), glm::dot(point - middle, right));
  };
  std::sort(points.begin(), points.end(),
            [&](const glm::dvec3& a, const glm::dvec3& b) { return angle(a) < angle(b); });
  return {points.begin(), points.end()};
}

}  // namespace

LightFrame LightFrameOf(const LocalBox& box, const glm::dvec3& towards_sun) {
  LightFrame frame;
  frame.towards_sun = towards_sun;
  const auto [right, up] = Across(towards_sun);
  frame.right = right;
  frame.up = up;
  frame.half_extent_m = glm::dvec2(0.0);
  for (const glm::dvec3& corner : Corners(box)) {
    frame.half_extent_m = glm::max(
        frame.half_extent_m, glm::abs(glm::dvec2(glm::dot(corner, right), glm::dot(corner, up))));
  }
  return frame;
}

Slicing SliceBox(const LocalBox& box, const glm::dvec3& towards_sun, const glm::dvec3& towards_eye,
                 int count) {
  Slicing slicing;
  slicing.front_to_back = glm::dot(towards_sun, towards_eye) >= 0.0;
  slicing.normal =
      glm::normalize(slicing.front_to_back ? towards_sun + towards_eye : towards_sun - towards_eye);
  const std::array<glm::dvec3, 8> corners = Corners(box);
  double reach_m = 0.0;
  for (const glm::dvec3& corner : corners) {
    reach_m = std::max(reach_m, glm::dot(slicing.normal, corner));
  }
  slicing.spacing_m = 2.0 * reach_m / count;
  slicing.light_path_m = slicing.spacing_m / glm::dot(slicing.normal, towards_sun);
  slicing.slices.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) {
    const double distance_m = reach_m - (k + 0.5) * slicing.spacing_m;
    slicing.slices.push_back({distance_m, CutBox(corners, slicing.normal, distance_m)});
  }
  return slicing;
}

}  // namespace thunderhead::renderers
