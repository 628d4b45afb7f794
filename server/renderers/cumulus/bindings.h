// shaders/cumulus/bindings.glsl for C++.
#pragma once

namespace thunderhead::shaders {

#include "shaders/cumulus/bindings.glsl"

}  // namespace thunderhead::shaders
