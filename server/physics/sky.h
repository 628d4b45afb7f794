// Sunlight and the clear sky: the GLSL of shaders/physics/{sky,air}.glsl compiled for the CPU, and its
// means over the sky.
#pragma once

#include "glm/common.hpp"
#include "glm/exponential.hpp"
#include "glm/geometric.hpp"
#include "glm/vec3.hpp"

namespace thunderhead::physics {
namespace glsl {

using glm::clamp;
using glm::dot;
using glm::exp;
using glm::max;
using glm::sqrt;
using glm::vec3;
// clang-format off: air needs sky
#include "shaders/physics/sky.glsl"
#include "shaders/physics/air.glsl"
// clang-format on

}  // namespace glsl

// Light from the whole sky, in units of the sun's irradiance above the atmosphere.
struct SkyLight {
  glm::vec3 mean_radiance{0.0F};  // over the upper hemisphere
  glm::vec3 irradiance{0.0F};     // on level ground
};

// Integrates glsl::sky_radiance over the upper hemisphere for the sun in unit `towards_sun`.
SkyLight SkyLightOf(const glm::vec3& towards_sun);

}  // namespace thunderhead::physics
