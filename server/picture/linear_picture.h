// A picture of linear radiance, drawn or traced, before any tone mapping.
#pragma once

#include <vector>

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"

namespace thunderhead::picture {

// Rows are from top to bottom.
struct LinearPicture {
  glm::ivec2 size_px{0};
  std::vector<glm::vec3> radiance;
  // Standard error of each pixel's radiance if that is an estimate. It is infinite for pixels with
  // unknown error. Empty for a picture without noise, or if no caller needs it.
  std::vector<glm::vec3> standard_error{};
  // Share of each pixel that the storm covers, 0 to 1. Empty if it is not known.
  std::vector<float> opacity{};
  // The storm's optical depth along the ray through each pixel's centre, and the distance in m from
  // the ray's start at which it reaches 1. The distance is infinite if the depth does not reach 1.
  // Both are empty unless requested.
  std::vector<float> optical_depth{};
  std::vector<float> depth_one_distance_m{};
};

}  // namespace thunderhead::picture
