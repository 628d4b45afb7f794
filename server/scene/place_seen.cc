#include "scene/place_seen.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "scene/drawn_fields.h"
#include "scene/view.h"
#include "volume/terrain.h"

namespace thunderhead::scene {
namespace {

// A ray through less cloud is taken to show what lies behind.
constexpr double kThinnest_depth = 0.1;
// Dense cloud behind this depth is not seen.
constexpr double kDeepest_depth = 20.0;

struct Span {
  double begin_m = 0.0;
  double end_m = 0.0;
};

// Of the ray in the box that holds the condensate, before `end_m`; empty if they do not meet.
Span Within(const volume::HydrometeorFields& fields, const glm::dvec3& origin_m,
            const glm::dvec3& direction, double end_m) {
  const volume::RegularGrid& grid = fields.grid;
  if (fields.condensate.Empty()) return {};
  const glm::dvec3 low_m = grid.low_corner_m + glm::dvec3(fields.condensate.low) * grid.spacing_m;
  const glm::dvec3 high_m = grid.low_corner_m + glm::dvec3(fields.condensate.high) * grid.spacing_m;
  Span span{0.0, end_m};
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) {
      if (origin_m[axis] < low_m[axis] || origin_m[axis] > high_m[axis]) return {};
      continue;
    }
    double near_m = (low_m[axis] - origin_m[axis]) / direction[axis];
    double far_m = (high_m[axis] - origin_m[axis]) / direction[axis];
    if (near_m > far_m) std::swap(near_m, far_m);
    span.begin_m = std::max(span.begin_m, near_m);
    span.end_m = std::min(span.end_m, far_m);
  }
  return span;
}

// Half of the shortest way through a cell from side to side.
double Step_m(const volume::RegularGrid& grid, const glm::dvec3& direction) {
  double step_m = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) continue;
    step_m = std::min(step_m, 0.5 * grid.spacing_m[axis] / std::abs(direction[axis]));
  }
  return step_m;
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

// Heights of the ground, which falls away from the storm's middle as the Earth does unless the
// camera sees a flat world.
class Surface {
 public:
  Surface(const Scene& scene, const volume::HydrometeorFields& fields)
      : fields_(fields), view_(ViewOf(scene, fields)) {}

  double Height_m(const glm::dvec3& place_m) const {
    const glm::dvec2 away_m = glm::dvec2(place_m) - view_.touch_m;
    const double fall_m = 0.5 * view_.ground_curvature_per_m * glm::dot(away_m, away_m);
    return volume::TerrainHeight_m(fields_, glm::dvec2(place_m)) - fall_m;
  }

 private:
  const volume::HydrometeorFields& fields_;
  const View view_;
};

// Where the ray first goes below the ground, in steps that grow with the distance; within
// `kFarthest_m`.
std::optional<double> MeetsGround_m(const Surface& ground, const glm::dvec3& origin_m,
                                    const glm::dvec3& direction) {
  constexpr double kFarthest_m = 2e8;
  const auto is_below = [&](double along_m) {
    const glm::dvec3 place_m = origin_m + along_m * direction;
    return place_m.z < ground.Height_m(place_m);
  };
  if (is_below(0.0)) return std::nullopt;
  double before_m = 0.0;
  while (before_m < kFarthest_m) {
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

}  // namespace

glm::dvec3 PlaceSeen(const Scene& scene, const volume::HydrometeorFields& fields,
                     const glm::dvec3& origin_m, const glm::dvec3& direction) {
  const std::optional<double> ground_m = MeetsGround_m(Surface(scene, fields), origin_m, direction);
  const volume::RegularGrid& grid = fields.grid;
  const Span span = Within(fields, origin_m, direction,
                           ground_m.value_or(std::numeric_limits<double>::infinity()));
  const Medium medium(scene, fields);
  const double step_m = Step_m(grid, direction);
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
