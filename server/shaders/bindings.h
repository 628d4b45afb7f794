// Compiles common/bindings.glsl as C++.
#pragma once

namespace thunderhead::shaders {

#include "shaders/common/bindings.glsl"

}  // namespace thunderhead::shaders
