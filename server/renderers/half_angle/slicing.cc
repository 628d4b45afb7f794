#include "renderers/half_angle/slicing.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "glm/common.hpp"
#include "glm/geometric.hpp"

namespace thunderhead::renderers {

Slicing SliceBox(const LocalBox& box, const glm::dvec3& towards_sun, const glm::dvec3& towards_eye,
                 int count) {
  Slicing slicing;
  const bool eye_on_suns_side = glm::dot(towards_sun, towards_eye) >= 0.0;
  slicing.normal =
      glm::normalize(eye_on_suns_side ? towards_sun + towards_eye : towards_sun - towards_eye);
  const std::array<glm::dvec3, 8> corners = CornersOf(box);
  double reach_m = 0.0;
  for (const glm::dvec3& corner : corners) {
    reach_m = std::max(reach_m, glm::dot(slicing.normal, corner));
  }
  slicing.count = count;
  slicing.spacing_m = 2.0 * reach_m / count;
  slicing.first_m = reach_m - 0.5 * slicing.spacing_m;
  slicing.light_path_m = slicing.spacing_m / glm::dot(slicing.normal, towards_sun);
  return slicing;
}

SliceOrder OrderOf(const Slicing& slicing, const scene::View& view) {
  const double middle = glm::dot(view.forward, slicing.normal);
  const double across = std::abs(glm::dot(view.right, slicing.normal)) * view.tan_half_width +
                        std::abs(glm::dot(view.up, slicing.normal)) * view.tan_half_height;
  if (std::abs(middle) <= across) return SliceOrder::kBoth;
  return middle < 0.0 ? SliceOrder::kAlong : SliceOrder::kAgainst;
}

}  // namespace thunderhead::renderers
