// Some GPUs compute far faster than they rasterize: of an H100's 132 multiprocessors only a few run
// fragment shaders. So a fragment shader that draws a whole target can run as a compute shader in
// its place. Works on texts; knows no GL.
#pragma once

#include <string>

namespace thunderhead::gl {

// `fragment`, without a `#version`, as the part of a compute shader that draws one pixel;
// common/whole_target.glsl is the rest. Outputs are declared one a line, `out TYPE NAME;` or
// `layout(location = N) out TYPE NAME;`, float or vec4, under no condition; the only input is
// `position`; nothing is discarded and no derivatives are taken.
std::string AsComputedPixel(const std::string& fragment);

}  // namespace thunderhead::gl
