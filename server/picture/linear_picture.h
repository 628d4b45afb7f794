// A picture as light: linear radiance, whether drawn or traced, before any tone mapping.
#pragma once

#include <vector>

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"

namespace thunderhead::picture {

// Rows from top to bottom.
struct LinearPicture {
  glm::ivec2 size_px{0};
  std::vector<glm::vec3> radiance;
  // Of each pixel's radiance, where that is an estimate; infinite where it is not known. Empty for
  // a picture without noise, or where nobody needs it.
  std::vector<glm::vec3> standard_error{};
  // Share of each pixel that the storm covers, 0 to 1; empty where that is not known.
  std::vector<float> opacity{};
  // Of the storm along the ray through each pixel's middle, and the distance from the ray's
  // beginning at which it reaches 1, in m; infinite where it does not. Empty where nobody asked.
  std::vector<float> optical_depth{};
  std::vector<float> depth_one_distance_m{};
};

}  // namespace thunderhead::picture
