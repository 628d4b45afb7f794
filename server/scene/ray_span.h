// The part of a ray that lies in a box, and the step length for walking through the box's cells.
#pragma once

#include "glm/vec3.hpp"
#include "volume/grid.h"

namespace thunderhead::scene {

// A part of a ray, given by distances from the ray's origin. It is empty if `end_m` is not greater
// than `begin_m`.
struct Span {
  double begin_m = 0.0;
  double end_m = 0.0;
};

// Returns the part of the ray that lies in the box `low_m` to `high_m` and is nearer than `end_m`.
Span SpanWithin(const glm::dvec3& low_m, const glm::dvec3& high_m, const glm::dvec3& origin_m,
                const glm::dvec3& direction, double end_m);

// Returns half of the shortest path along `direction` through a cell from one side to the opposite
// side.
double HalfCell_m(const volume::RegularGrid& grid, const glm::dvec3& direction);

}  // namespace thunderhead::scene
