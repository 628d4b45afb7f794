// Wyvill's field function as the shaders have it: the same text compiled as C++, so that tests
// check what the GPU runs.
#pragma once

#include "glm/common.hpp"
#include "glm/exponential.hpp"

namespace thunderhead::renderers::glsl {

using glm::max;
using glm::sqrt;
#include "shaders/physics/wyvill.glsl"

}  // namespace thunderhead::renderers::glsl
