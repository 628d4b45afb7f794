#include "scene/place_seen.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "scene/drawn_fields.h"
#include "scene/ground_hit.h"
#include "scene/ray_span.h"

namespace thunderhead::scene {
namespace {

// A ray through less cloud is taken to show what lies behind.
constexpr double kThinnest_depth = 0.1;
// Dense cloud behind this depth is not seen.
constexpr double kDeepest_depth = 20.0;

// Of the ray in the box that holds the condensate, before `end_m`; empty if they do not meet.
Span Within(const volume::HydrometeorFields& fields, const glm::dvec3& origin_m,
            const glm::dvec3& direction, double end_m) {
  const volume::RegularGrid& grid = fields.grid;
  if (fields.condensate.Empty()) return {};
  return SpanWithin(grid.low_corner_m + glm::dvec3(fields.condensate.low) * grid.spacing_m,
                    grid.low_corner_m + glm::dvec3(fields.condensate.high) * grid.spacing_m,
                    origin_m, direction, end_m);
}

class Medium {
 public:
  Medium(const Scene& scene, const volume::HydrometeorFields& fields)
      : fields_(fields), drawn_(DrawnFieldsOf(scene, fields)) {}

  double ExtinctionAt_per_m(const glm::dvec3& place_m) const {
    const volume::RegularGrid& grid = fields_.grid;
    const glm::ivec3 cell =
        glm::clamp(glm::ivec3(glm::floor((place_m - grid.low_corner_m) / grid.spacing_m)),
                   glm::ivec3(0), grid.cells - 1);
    float sum_per_m = 0.0F;
    for (const DrawnField& drawn : drawn_) {
      volume::AddExtinction(fields_.fields[drawn.index], drawn.mass_extinction,
                            grid.Offset(cell.x, cell.y, cell.z), 1, &sum_per_m);
    }
    return sum_per_m;
  }

 private:
  const volume::HydrometeorFields& fields_;
  const std::vector<DrawnField> drawn_;
};

}  // namespace

glm::dvec3 PlaceSeen(const Scene& scene, const volume::HydrometeorFields& fields,
                     const glm::dvec3& origin_m, const glm::dvec3& direction) {
  const std::optional<double> ground_m =
      Surface(scene, fields).MeetsRay_m(origin_m, direction, kFarthestGround_m);
  const volume::RegularGrid& grid = fields.grid;
  const Span span = Within(fields, origin_m, direction,
                           ground_m.value_or(std::numeric_limits<double>::infinity()));
  const Medium medium(scene, fields);
  const double step_m = HalfCell_m(grid, direction);
  // The depth behind each step, until nothing is seen through it.
  std::vector<double> depths;
  double depth = 0.0;
  for (double along_m = span.begin_m + step_m / 2.0; along_m < span.end_m && depth < kDeepest_depth;
       along_m += step_m) {
    depth += step_m * medium.ExtinctionAt_per_m(origin_m + along_m * direction);
    depths.push_back(depth);
  }
  if (depth >= kThinnest_depth) {
    const double half = -std::log(1.0 - 0.5 * (1.0 - std::exp(-depth)));
    const auto at = std::ranges::lower_bound(depths, half);
    const double along_m = span.begin_m + (static_cast<double>(at - depths.begin()) + 0.5) * step_m;
    return origin_m + along_m * direction;
  }
  if (ground_m.has_value()) return origin_m + *ground_m * direction;
  const glm::dvec3 middle_m = (grid.low_corner_m + grid.HighCorner_m()) / 2.0;
  return origin_m + std::max(0.0, glm::dot(middle_m - origin_m, direction)) * direction;
}

}  // namespace thunderhead::scene
