// Mesa's software renderer reads a uniform in a fragment shader once for every pixel (gallivm 22.3:
// a shader may start with some pixels off), in a vertex shader once for all. So a fragment shader's
// uniforms can be handed to it by the vertex shader, as inputs that do not vary. Works on texts;
// knows no GL.
#pragma once

#include <string>

namespace thunderhead::gl {

struct StageTexts {
  std::string vertex;
  std::string fragment;
};

// Both texts with that done. Uniforms are declared one a line, `uniform TYPE NAME;` or `uniform
// TYPE NAME[SIZE];`, arrays by literals and macros; samplers stay as they are. The uniforms keep
// their names for who sets them. What comes out may have more inputs than a device allows: then the
// program does not link.
StageTexts WithFlatUniforms(const StageTexts& texts);

}  // namespace thunderhead::gl
