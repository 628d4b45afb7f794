// Compiles shaders/paths/roulette.glsl as C++.
#pragma once

namespace thunderhead::reference {

#include "shaders/paths/roulette.glsl"

}  // namespace thunderhead::reference
