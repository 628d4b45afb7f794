#include "scene/ground_hit.h"

#include <algorithm>

#include "glm/geometric.hpp"
#include "glm/vec2.hpp"
#include "volume/terrain.h"

namespace thunderhead::scene {

Surface::Surface(const Scene& scene, const volume::HydrometeorFields& fields)
    : fields_(fields), view_(ViewOf(scene, fields)) {}

double Surface::WorldZ_m(const glm::dvec3& place_m) const {
  const glm::dvec2 away_m = glm::dvec2(place_m) - view_.touch_m;
  const double fall_m = 0.5 * view_.ground_curvature_per_m * glm::dot(away_m, away_m);
  return volume::TerrainHeight_m(fields_, glm::dvec2(place_m)) - fall_m;
}

std::optional<double> Surface::MeetsRay_m(const glm::dvec3& origin_m, const glm::dvec3& direction,
                                          double farthest_m) const {
  const auto is_below = [&](double along_m) {
    const glm::dvec3 place_m = origin_m + along_m * direction;
    return place_m.z < WorldZ_m(place_m);
  };
  if (is_below(0.0)) return std::nullopt;
  double before_m = 0.0;
  while (before_m < farthest_m) {
    double after_m = before_m + std::max(50.0, before_m / 100.0);
    if (!is_below(after_m)) {
      before_m = after_m;
      continue;
    }
    while (after_m - before_m > 1.0) {
      const double middle_m = (before_m + after_m) / 2.0;
      (is_below(middle_m) ? after_m : before_m) = middle_m;
    }
    return after_m;
  }
  return std::nullopt;
}

}  // namespace thunderhead::scene
