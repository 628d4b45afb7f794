// The part of a ray that lies in a box, and the steps in which to walk through its cells.
#pragma once

#include "glm/vec3.hpp"
#include "volume/grid.h"

namespace thunderhead::scene {

// A part of a ray, by distances from its origin; empty if `end_m` is not beyond `begin_m`.
struct Span {
  double begin_m = 0.0;
  double end_m = 0.0;
};

// The part of the ray that lies in the box `low_m` to `high_m`, before `end_m`.
Span SpanWithin(const glm::dvec3& low_m, const glm::dvec3& high_m, const glm::dvec3& origin_m,
                const glm::dvec3& direction, double end_m);

// Half of the shortest path through a cell from side to side.
double HalfCell_m(const volume::RegularGrid& grid, const glm::dvec3& direction);

}  // namespace thunderhead::scene
