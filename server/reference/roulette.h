// shaders/paths/roulette.glsl for C++.
#pragma once

namespace thunderhead::reference {

#include "shaders/paths/roulette.glsl"

}  // namespace thunderhead::reference
