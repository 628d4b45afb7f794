#include "scene/place_seen.h"

#include <algorithm>
#include <optional>

#include "glm/geometric.hpp"
#include "scene/storm_ray.h"

namespace thunderhead::scene {

glm::dvec3 PlaceSeen(const Scene& scene, const volume::HydrometeorFields& fields,
                     const glm::dvec3& origin_m, const glm::dvec3& direction) {
  const StormRay ray(scene, fields, origin_m, direction);
  if (const std::optional<double> along_m = ray.WhereSeen_m()) return ray.At_m(*along_m);
  const volume::RegularGrid& grid = fields.grid;
  const glm::dvec3 middle_m = (grid.low_corner_m + grid.HighCorner_m()) / 2.0;
  return ray.At_m(std::max(0.0, glm::dot(middle_m - origin_m, direction)));
}

}  // namespace thunderhead::scene
