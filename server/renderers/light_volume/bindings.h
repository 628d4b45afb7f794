// shaders/light_volume/bindings.glsl for C++.
#pragma once

namespace thunderhead::shaders {

#include "shaders/light_volume/bindings.glsl"

}  // namespace thunderhead::shaders
