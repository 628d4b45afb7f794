// Moves uniforms from fragment shaders to vertex shaders. In a fragment shader, Mesa's software
// renderer reads a uniform once for every pixel, because some pixels can be inactive (gallivm
// 22.3). In a vertex shader it reads a uniform once. The vertex shader therefore passes the
// fragment shader's uniforms on as flat inputs. The code works on texts and does not use GL.
#pragma once

#include <string>

namespace thunderhead::gl {

struct StageTexts {
  std::string vertex;
  std::string fragment;
};

// Returns both texts with the uniforms moved. Each uniform must be declared on its own line, as
// `uniform TYPE NAME;` or `uniform TYPE NAME[SIZE];`. Array sizes are literals or macros. Samplers
// stay unchanged. The uniforms keep their names for the code that sets them. If the result has more
// inputs than the device allows, the program does not link.
StageTexts WithFlatUniforms(const StageTexts& texts);

}  // namespace thunderhead::gl
