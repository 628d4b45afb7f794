// Fields of crops on the one-mile grid of the Great Plains: a pattern for the ground of idealised
// runs, which have no land use. It is decoration: which field is where follows from a random
// number alone. The geometry is that of shaders/physics/ground_cover.glsl, compiled for the CPU
// here; this has the map of fields, and samples it as a GPU does.
#pragma once

#include <cstdint>
#include <vector>

#include "glm/common.hpp"
#include "glm/exponential.hpp"
#include "glm/geometric.hpp"
#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "glm/vec4.hpp"

namespace thunderhead::physics {
namespace glsl {

using glm::abs;
using glm::clamp;
using glm::dot;
using glm::exp;
using glm::floor;
using glm::length;
using glm::log2;
using glm::max;
using glm::min;
using glm::mix;
using glm::sqrt;
using glm::vec2;
using glm::vec3;
using glm::vec4;
#include "shaders/physics/ground_cover.glsl"

}  // namespace glsl

// The map: brightness, dryness and centre pivots of fields (the red, green and blue of a texel of
// 402 m), and the grain (alpha; texels of 0.8 m). The means of the first two and of the last are
// 128 / 255.
class FieldPattern {
 public:
  // The one pattern that there is.
  static const FieldPattern& Plains();

  // kFieldMapCells squared texels.
  const std::vector<glm::u8vec4>& Texels() const { return texels_; }

  // Reflectance by colour over the ground's on average (of the same luminance), at a place in world
  // metres, averaged over a footprint in metres. `contrast` is 1 for all of the pattern.
  glm::vec3 Reflectance(const glm::vec2& place_m, const glm::vec2& footprint_m,
                        float contrast) const;

  // The factor of the grain alone.
  float Grain(const glm::vec2& place_m, const glm::vec2& footprint_m, float contrast) const;

 private:
  FieldPattern();
  glm::vec4 Sample(const glm::vec2& cell, float level) const;
  glm::vec4 Linear(const glm::vec2& cell, int level) const;

  std::vector<glm::u8vec4> texels_;
  std::vector<std::vector<glm::vec4>> levels_;  // the mip chain, 0 to 1
};

// The largest contrast at which nothing reflects more than it receives, at a mean reflectance.
float FieldContrast(const glm::vec3& mean_reflectance);

}  // namespace thunderhead::physics
