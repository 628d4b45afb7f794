// The geometry of a picture: where the eye is and how pixels map to rays. Derived from a scene's
// camera.
#pragma once

#include "glm/mat4x4.hpp"
#include "glm/vec3.hpp"
#include "scene/scene.h"

namespace thunderhead::scene {

// A perspective view. `right`, `up` and `forward` are unit vectors; a ray through normalised device
// coordinates (x, y) has the direction forward + x tan_half_width right + y tan_half_height up.
struct View {
  glm::dvec3 eye_m{0.0};
  glm::dvec3 right{1.0, 0.0, 0.0};
  glm::dvec3 up{0.0, 0.0, 1.0};
  glm::dvec3 forward{0.0, 1.0, 0.0};
  double tan_half_width = 1.0;
  double tan_half_height = 1.0;
};

// The unit vector that points to azimuth (clockwise from north) and elevation.
glm::dvec3 Direction(double azimuth_deg, double elevation_deg);

// The view of `camera` on a picture of the given aspect ratio (width over height).
View ViewOf(const OrbitCamera& camera, double aspect_ratio);

// The camera that frames the box `low_m` to `high_m` whole, standing and looking as `camera` does.
OrbitCamera Framing(OrbitCamera camera, const glm::dvec3& low_m, const glm::dvec3& high_m,
                    double aspect_ratio);

}  // namespace thunderhead::scene
