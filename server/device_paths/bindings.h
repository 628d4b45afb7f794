// Compiles shaders/paths/bindings.glsl as C++, so that C++ code and shaders use the same constants.
#pragma once

namespace thunderhead::shaders {

#include "shaders/paths/bindings.glsl"

}  // namespace thunderhead::shaders
