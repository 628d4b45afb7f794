// A ray split into pieces along which a storm's values are polynomials. The fields have values at
// cell centres, which are interpolated trilinearly. Between two planes of cell centres the values
// are therefore cubic along the ray. Beyond the outermost centres they are constant. Integrals and
// maxima are exact because they are computed from the cubics.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "glm/vec3.hpp"
#include "scene/ray_span.h"
#include "volume/grid.h"

namespace thunderhead::scene {

// A cubic polynomial of u, the position in a piece of the ray: 0 at its start, 1 at its end.
struct Cubic {
  std::array<double, 4> factors{};  // coefficients of 1, u, u^2, u^3

  // Returns the cubic with these values at u = 0, 1/3, 2/3 and 1.
  static Cubic Through(const std::array<double, 4>& values);

  double At(double u) const;
  // Returns the integral from 0 to `u`.
  double Integral(double u) const;
  // Returns the u at which the cubic is largest.
  double Largest() const;
  // Returns the smallest u at which the integral from 0 reaches `value`, or 1 if the integral does
  // not reach it. The cubic must not be negative anywhere.
  double WhereIntegralIs(double value) const;
};

// The eight cells whose centres are the corners of a box around a place.
struct Corners {
  std::array<std::size_t, 8> cells{};  // x varies fastest, then y, then z
  glm::ivec3 low{0};
  glm::ivec3 high{0};

  static Corners Around(const volume::RegularGrid& grid, const glm::dvec3& place_m);
  // Returns the position of `place_m` between the cell centres, from 0 to 1 along each axis.
  glm::dvec3 ShareOf(const volume::RegularGrid& grid, const glm::dvec3& place_m) const;
};

using CornerValues = std::array<double, 8>;

double Linear(const CornerValues& values, const glm::dvec3& share);

struct RayPiece {
  double begin_m = 0.0;
  double end_m = 0.0;
  Corners corners;
  glm::dvec3 begin_share{0.0};
  glm::dvec3 end_share{0.0};

  double Length_m() const { return end_m - begin_m; }
  double Along_m(double u) const { return begin_m + u * Length_m(); }
  Cubic Of(const CornerValues& values) const;
};

// Returns the pieces of the ray within `span`, which must lie in the grid's box. `direction` must
// have the length 1.
std::vector<RayPiece> PiecesOf(const volume::RegularGrid& grid, const glm::dvec3& origin_m,
                               const glm::dvec3& direction, const Span& span);

}  // namespace thunderhead::scene
