// Sunlight by height for shaders that include common/sunlight.glsl.
#pragma once

#include "gl/program.h"
#include "renderers/render_settings.h"

namespace thunderhead::renderers {

// Sets the uniforms. `middle_height_m` is the height above sea level of the shader's origin.
void BindSunlight(const gl::Program& program, const Illumination& illumination,
                  double middle_height_m);

}  // namespace thunderhead::renderers
