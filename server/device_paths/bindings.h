// Compiles shaders/paths/bindings.glsl as C++.
#pragma once

namespace thunderhead::shaders {

#include "shaders/paths/bindings.glsl"

}  // namespace thunderhead::shaders
