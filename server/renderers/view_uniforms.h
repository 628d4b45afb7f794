// A view as shaders take it: the rays of common/view.glsl, and the matrix and eye of rasterised
// geometry.
#pragma once

#include "gl/program.h"
#include "glm/mat4x4.hpp"
#include "glm/vec4.hpp"
#include "scene/view.h"

namespace thunderhead::renderers {

// Sets the uniforms of common/view.glsl for coordinates in metres from `middle_m`.
void BindRays(const gl::Program& program, const scene::View& view, const glm::dvec3& middle_m);

// From metres around `middle_m` to clip space.
glm::mat4 ClipFromLocal(const scene::View& view, const glm::dvec3& middle_m);

// The eye e such that the ray that meets local p has the direction p e.w - e.xyz, also where the
// eye is infinitely far.
glm::vec4 EyeOf(const scene::View& view, const glm::dvec3& middle_m);

}  // namespace thunderhead::renderers
