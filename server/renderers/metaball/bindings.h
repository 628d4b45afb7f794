// shaders/metaball/bindings.glsl for C++.
#pragma once

namespace thunderhead::shaders {

#include "shaders/metaball/bindings.glsl"

}  // namespace thunderhead::shaders
