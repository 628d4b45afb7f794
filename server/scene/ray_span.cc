#include "scene/ray_span.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace thunderhead::scene {

Span SpanWithin(const glm::dvec3& low_m, const glm::dvec3& high_m, const glm::dvec3& origin_m,
                const glm::dvec3& direction, double end_m) {
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

double HalfCell_m(const volume::RegularGrid& grid, const glm::dvec3& direction) {
  double step_m = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) continue;
    step_m = std::min(step_m, 0.5 * grid.spacing_m[axis] / std::abs(direction[axis]));
  }
  return step_m;
}

}  // namespace thunderhead::scene
