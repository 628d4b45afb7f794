// Converts fragment shaders to compute shaders. Some GPUs run compute shaders far faster than
// fragment shaders: an H100 runs fragment shaders on only a few of its 132 multiprocessors. A
// fragment shader that draws every pixel of a target can therefore run as a compute shader instead.
// The code works on texts and does not use GL.
#pragma once

#include <string>

namespace thunderhead::gl {

// Returns `fragment`, which has no `#version`, as the part of a compute shader that draws one
// pixel. The rest of the compute shader is common/whole_target.glsl.
//
// Each output must be declared on its own line, as `out TYPE NAME;` or `layout(location = N) out
// TYPE NAME;`, with type float or vec4. Declarations must not depend on preprocessor conditions.
// The only input is `position`. The shader must not discard fragments or take derivatives.
std::string AsComputedPixel(const std::string& fragment);

}  // namespace thunderhead::gl
