// Converts fragment shaders to compute shaders. Some GPUs compute far faster than they rasterize:
// only a few of an H100's 132 multiprocessors run fragment shaders. A fragment shader that draws a
// whole target can therefore run as a compute shader instead. The code works on texts and does not
// use GL.
#pragma once

#include <string>

namespace thunderhead::gl {

// Returns `fragment`, without a `#version`, as the part of a compute shader that draws one pixel.
// The rest of the shader is common/whole_target.glsl.
//
// Outputs must be declared one a line, as `out TYPE NAME;` or `layout(location = N) out TYPE
// NAME;`, with type float or vec4, and under no preprocessor condition. The only input is
// `position`. The shader must not discard fragments or take derivatives.
std::string AsComputedPixel(const std::string& fragment);

}  // namespace thunderhead::gl
