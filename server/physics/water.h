// Light that a water surface reflects: shaders/physics/water.glsl, compiled for the CPU.
#pragma once

#include "glm/common.hpp"
#include "glm/exponential.hpp"
#include "glm/geometric.hpp"
#include "glm/vec3.hpp"

namespace thunderhead::physics::glsl {

using glm::clamp;
using glm::dot;
using glm::exp;
using glm::log;
using glm::max;
using glm::normalize;
using glm::sqrt;
using glm::vec3;
#include "shaders/physics/water.glsl"

}  // namespace thunderhead::physics::glsl
