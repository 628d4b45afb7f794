// Wyvill's field function from the shaders, compiled as C++. Tests therefore check the code that
// the GPU runs.
#pragma once

#include "glm/common.hpp"
#include "glm/exponential.hpp"

namespace thunderhead::renderers::glsl {

using glm::max;
using glm::sqrt;
#include "shaders/physics/wyvill.glsl"

}  // namespace thunderhead::renderers::glsl
