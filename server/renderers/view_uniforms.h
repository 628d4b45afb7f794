// A view in the form that shaders need: the uniforms for the rays of common/view.glsl, and the
// matrix and eye position for rasterised geometry.
#pragma once

#include "gl/program.h"
#include "glm/mat4x4.hpp"
#include "glm/vec4.hpp"
#include "scene/view.h"

namespace thunderhead::renderers {

// Sets the uniforms of common/view.glsl for coordinates in metres from `middle_m`.
void BindRays(const gl::Program& program, const scene::View& view, const glm::dvec3& middle_m);

// Returns the transformation from metres around `middle_m` to clip space.
glm::mat4 ClipFromLocal(const scene::View& view, const glm::dvec3& middle_m);

// Returns an eye e in homogeneous coordinates. The ray through local point p has the direction p
// e.w - e.xyz. This form also represents an eye at infinity.
glm::vec4 EyeOf(const scene::View& view, const glm::dvec3& middle_m);

}  // namespace thunderhead::renderers
