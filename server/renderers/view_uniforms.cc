#include "renderers/view_uniforms.h"

#include "glm/ext/matrix_clip_space.hpp"
#include "glm/ext/matrix_transform.hpp"
#include "shaders/uniforms.h"

namespace thunderhead::renderers {

void BindRays(const gl::Program& program, const scene::View& view, const glm::dvec3& middle_m) {
  program.Set(uniform::ray_origin_m, glm::vec3(view.eye_m - middle_m));
  program.Set(uniform::ray_origin_right_m, glm::vec3(view.right * view.half_width_m));
  program.Set(uniform::ray_origin_up_m, glm::vec3(view.up * view.half_height_m));
  program.Set(uniform::ray_forward, glm::vec3(view.forward));
  program.Set(uniform::ray_right, glm::vec3(view.right * view.tan_half_width));
  program.Set(uniform::ray_up, glm::vec3(view.up * view.tan_half_height));
}

glm::mat4 ClipFromLocal(const scene::View& view, const glm::dvec3& middle_m) {
  // These distances include everything that is drawn.
  const double near_m = 1.0;
  const double far_m = 1e8;
  const glm::dmat4 clip_from_view =
      view.Orthographic()
          ? glm::ortho(-view.half_width_m, view.half_width_m, -view.half_height_m,
                       view.half_height_m, near_m, far_m)
          : glm::frustum(-view.tan_half_width * near_m, view.tan_half_width * near_m,
                         -view.tan_half_height * near_m, view.tan_half_height * near_m, near_m,
                         far_m);
  const glm::dvec3 eye = view.eye_m - middle_m;
  return clip_from_view * glm::lookAt(eye, eye + view.forward, view.up);
}

glm::vec4 EyeOf(const scene::View& view, const glm::dvec3& middle_m) {
  if (view.Orthographic()) return {-glm::vec3(view.forward), 0.0F};
  return {glm::vec3(view.eye_m - middle_m), 1.0F};
}

}  // namespace thunderhead::renderers
