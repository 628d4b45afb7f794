// Compiles shaders/light_volume/bindings.glsl as C++.
#pragma once

namespace thunderhead::shaders {

#include "shaders/light_volume/bindings.glsl"

}  // namespace thunderhead::shaders
