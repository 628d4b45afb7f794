// Compiles shaders/half_angle/bindings.glsl as C++.
#pragma once

namespace thunderhead::shaders {

#include "shaders/half_angle/bindings.glsl"

}  // namespace thunderhead::shaders
