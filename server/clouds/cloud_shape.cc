#include "clouds/cloud_shape.h"

#include <cmath>

#include "clouds/repeatable_math.h"

namespace thunderhead::clouds {

glm::dmat3 AxesOf(const glm::dvec3& rotation_deg) {
  const glm::dvec3 s(SineOfDegrees(rotation_deg.x), SineOfDegrees(rotation_deg.y),
                     SineOfDegrees(rotation_deg.z));
  const glm::dvec3 c(CosineOfDegrees(rotation_deg.x), CosineOfDegrees(rotation_deg.y),
                     CosineOfDegrees(rotation_deg.z));
  return {glm::dvec3(c.y * c.z, c.y * s.z, -s.y),
          glm::dvec3(s.x * s.y * c.z - c.x * s.z, s.x * s.y * s.z + c.x * c.z, s.x * c.y),
          glm::dvec3(c.x * s.y * c.z + s.x * s.z, c.x * s.y * s.z - s.x * c.z, c.x * c.y)};
}

Quadric::Quadric(const Ellipsoid& ellipsoid) : centre_m_(ellipsoid.centre_m) {
  const glm::dmat3 axes = AxesOf(ellipsoid.rotation_deg);
  glm::dvec3 extent_squared(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    const double radius_m = ellipsoid.radii_m[axis];
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        matrix_[i][j] += axes[axis][i] * axes[axis][j] / (radius_m * radius_m);
      }
      extent_squared[i] += axes[axis][i] * axes[axis][i] * radius_m * radius_m;
    }
  }
  for (int i = 0; i < 3; ++i) half_extent_m_[i] = std::sqrt(extent_squared[i]);
}

}  // namespace thunderhead::clouds
