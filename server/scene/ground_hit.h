// Intersections of rays with the ground. The ground is the file's terrain, which curves away from
// the storm with the Earth unless the camera sees a flat world.
#pragma once

#include <optional>

#include "glm/vec3.hpp"
#include "scene/scene.h"
#include "scene/view.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::scene {

class Surface {
 public:
  // `fields` must outlive the surface.
  Surface(const Scene& scene, const volume::HydrometeorFields& fields);

  // Returns the z coordinate of the ground below or above a place, in world coordinates.
  double WorldZ_m(const glm::dvec3& place_m) const;

  // Returns the distance along the ray at which the ray first goes below the ground, accurate to a
  // metre. Returns nothing if that is beyond `farthest_m` or if the ray begins below the ground.
  // `direction` must have the length 1. The search steps grow with the distance, so narrow distant
  // peaks can be missed.
  std::optional<double> MeetsRay_m(const glm::dvec3& origin_m, const glm::dvec3& direction,
                                   double farthest_m) const;

 private:
  const volume::HydrometeorFields& fields_;
  const View view_;
};

// The farthest distance that any ray needs.
inline constexpr double kFarthestGround_m = 2e8;

}  // namespace thunderhead::scene
