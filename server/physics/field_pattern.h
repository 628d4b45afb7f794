// A pattern of crop fields on the one-mile grid of the Great Plains. It covers the ground of
// idealised runs, which have no land use. The pattern is decoration: random numbers decide which
// field is where. The geometry comes from shaders/physics/ground_cover.glsl, compiled for the CPU
// here. This file adds the map of fields, and samples it as a GPU does.
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

// The map of the crop fields and of the grain, which is uneven soil and plants within a field. Red,
// green and blue hold a field's brightness, its dryness, and whether a centre pivot waters it. A
// texel covers 402 m for them. Alpha holds the grain, which is looked up at a finer scale: a texel
// covers 0.8 m. The means of red, green and alpha are 128 / 255.
class FieldPattern {
 public:
  // Returns the only pattern, which is created on first use.
  static const FieldPattern& Plains();

  // Returns the texels, kFieldMapCells along each side.
  const std::vector<glm::u8vec4>& Texels() const { return texels_; }

  // Returns the reflectance in red, green and blue at a place in world metres, averaged over a
  // footprint in metres. It is relative to the ground's mean reflectance. The mean over all fields
  // has the same luminance as the ground, but another hue. A `contrast` of 1 shows the full
  // pattern.
  glm::vec3 Reflectance(const glm::vec2& place_m, const glm::vec2& footprint_m,
                        float contrast) const;

  // Returns only the factor of the grain in the reflectance.
  float Grain(const glm::vec2& place_m, const glm::vec2& footprint_m, float contrast) const;

 private:
  FieldPattern();
  glm::vec4 Sample(const glm::vec2& cell, float level) const;
  glm::vec4 Linear(const glm::vec2& cell, int level) const;

  std::vector<glm::u8vec4> texels_;
  std::vector<std::vector<glm::vec4>> levels_;  // the mip chain, with values from 0 to 1
};

// Returns the largest contrast at which no texel reflects more light than it receives, for ground
// with the given mean reflectance.
float FieldContrast(const glm::vec3& mean_reflectance);

}  // namespace thunderhead::physics
