// A rasterised or path-traced picture of linear radiance, before any tone mapping.
#pragma once

#include <vector>

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"

namespace thunderhead::picture {

// Each vector holds one value for each pixel, in rows from top to bottom.
struct LinearPicture {
  glm::ivec2 size_px{0};
  std::vector<glm::vec3> radiance;
  // Standard error of each pixel's radiance if the radiance is an estimate. It is infinite for
  // pixels whose error is unknown. The vector is empty for a picture without noise, or if no caller
  // needs it.
  std::vector<glm::vec3> standard_error{};
  // Share of each pixel that the storm covers, 0 to 1. The vector is empty if the opacity is not
  // known.
  std::vector<float> opacity{};
  // The storm's optical depth along the ray through each pixel's centre, and the distance in metres
  // from the ray's start at which the optical depth reaches 1. The distance is infinite if it does
  // not reach 1. Both vectors are empty unless requested.
  std::vector<float> optical_depth{};
  std::vector<float> depth_one_distance_m{};
};

}  // namespace thunderhead::picture
