// Compiles shaders/metaball/bindings.glsl as C++.
#pragma once

namespace thunderhead::shaders {

#include "shaders/metaball/bindings.glsl"

}  // namespace thunderhead::shaders
