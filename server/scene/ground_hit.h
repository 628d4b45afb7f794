// Where a ray meets the ground: the file's terrain, which falls away from the storm as the Earth
// does unless the camera sees a flat world.
#pragma once

#include <optional>

#include "glm/vec3.hpp"
#include "scene/scene.h"
#include "scene/view.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::scene {

class Surface {
 public:
  // `fields` must outlive it.
  Surface(const Scene& scene, const volume::HydrometeorFields& fields);

  // Above sea level, in the coordinates of the world.
  double Height_m(const glm::dvec3& place_m) const;

  // How far along the ray, whose direction has the length 1, it first goes below the ground, exact
  // to a metre; nothing within `farthest_m`, or if it begins there. Steps grow with the distance.
  std::optional<double> MeetsRay_m(const glm::dvec3& origin_m, const glm::dvec3& direction,
                                   double farthest_m) const;

 private:
  const volume::HydrometeorFields& fields_;
  const View view_;
};

// As far as any ray goes.
inline constexpr double kFarthestGround_m = 2e8;

}  // namespace thunderhead::scene
