#include "scene/view.h"

#include <algorithm>
#include <cmath>

#include "glm/geometric.hpp"
#include "glm/trigonometric.hpp"

namespace thunderhead::scene {

glm::dvec3 Direction(double azimuth_deg, double elevation_deg) {
  const double azimuth = glm::radians(azimuth_deg);
  const double elevation = glm::radians(elevation_deg);
  return {std::sin(azimuth) * std::cos(elevation), std::cos(azimuth) * std::cos(elevation),
          std::sin(elevation)};
}

View ViewOf(const OrbitCamera& camera, double aspect_ratio) {
  View view;
  const glm::dvec3 towards_eye = Direction(camera.azimuth_deg, camera.elevation_deg);
  view.eye_m = camera.target_m + camera.distance_m * towards_eye;
  view.forward = -towards_eye;
  view.right = glm::normalize(glm::cross(view.forward, glm::dvec3(0.0, 0.0, 1.0)));
  view.up = glm::cross(view.right, view.forward);
  view.tan_half_height = std::tan(glm::radians(camera.field_of_view_deg) / 2.0);
  view.tan_half_width = view.tan_half_height * aspect_ratio;
  return view;
}

OrbitCamera Framing(OrbitCamera camera, const glm::dvec3& low_m, const glm::dvec3& high_m,
                    double aspect_ratio) {
  constexpr double kMargin = 1.05;
  camera.target_m = (low_m + high_m) / 2.0;
  const View view = ViewOf(camera, aspect_ratio);
  double distance_m = 1.0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 point((corner & 1) != 0 ? high_m.x : low_m.x,
                           (corner & 2) != 0 ? high_m.y : low_m.y,
                           (corner & 4) != 0 ? high_m.z : low_m.z);
    const glm::dvec3 offset = point - camera.target_m;
    const double towards_eye = -glm::dot(offset, view.forward);
    const double across = std::abs(glm::dot(offset, view.right)) / view.tan_half_width;
    const double along = std::abs(glm::dot(offset, view.up)) / view.tan_half_height;
    distance_m = std::max(distance_m, towards_eye + kMargin * std::max(across, along));
  }
  camera.distance_m = distance_m;
  return camera;
}

}  // namespace thunderhead::scene
