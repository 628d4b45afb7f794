// shaders/paths/bindings.glsl for C++.
#pragma once

namespace thunderhead::shaders {

#include "shaders/paths/bindings.glsl"

}  // namespace thunderhead::shaders
