// Compiles shaders/cumulus/bindings.glsl as C++.
#pragma once

namespace thunderhead::shaders {

#include "shaders/cumulus/bindings.glsl"

}  // namespace thunderhead::shaders
