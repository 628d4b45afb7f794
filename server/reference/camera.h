// The ray of each point of a picture, in perspective or with parallel rays.
#pragma once

#include "glm/geometric.hpp"
#include "glm/vec3.hpp"
#include "reference/brick_walk.h"
#include "scene/view.h"

namespace thunderhead::reference {

// A camera whose rays' origins and directions depend linearly on the place in the picture.
struct Camera {
  glm::dvec3 origin_m{0.0};        // origin of the ray through the picture's middle
  glm::dvec3 origin_right_m{0.0};  // change of the ray's origin from x = 0 to x = 1
  glm::dvec3 origin_up_m{0.0};
  glm::dvec3 forward{0.0, 1.0, 0.0};
  glm::dvec3 right{0.0};  // change of the ray's direction from x = 0 to x = 1
  glm::dvec3 up{0.0};

  // Converts a view, with or without perspective.
  static Camera Of(const scene::View& view) {
    return {view.eye_m,   view.right * view.half_width_m,   view.up * view.half_height_m,
            view.forward, view.right * view.tan_half_width, view.up * view.tan_half_height};
  }

  // Creates parallel rays in `direction` from every point of a rectangle.
  static Camera Parallel(const glm::dvec3& middle_m, const glm::dvec3& half_right_m,
                         const glm::dvec3& half_up_m, const glm::dvec3& direction) {
    return {middle_m, half_right_m, half_up_m, direction, {}, {}};
  }

  // Returns the ray through normalised device coordinates: x from -1 (left) to 1, y from -1
  // (bottom) to 1.
  Ray RayThrough(double x, double y) const {
    return {origin_m + x * origin_right_m + y * origin_up_m,
            glm::normalize(forward + x * right + y * up)};
  }
};

}  // namespace thunderhead::reference
