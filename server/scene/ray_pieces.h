// A ray in the pieces along which a storm's values are polynomials: values sit at cells' middles
// and are linear in x, y and z between them, so that along a ray they are of degree 3 from one
// plane of middles to the next. Beyond the outermost middles they stay what they are there.
// Integrals and maxima are therefore exact.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "glm/vec3.hpp"
#include "scene/ray_span.h"
#include "volume/grid.h"

namespace thunderhead::scene {

// Of a piece's share u, from 0 to 1.
struct Cubic {
  std::array<double, 4> factors{};  // of 1, u, u^2, u^3

  // The one with these values at 0, 1/3, 2/3 and 1.
  static Cubic Through(const std::array<double, 4>& values);

  double At(double u) const;
  // From 0 to `u`.
  double Integral(double u) const;
  // The u at which it is largest.
  double Largest() const;
  // The smallest u by which the integral of a cubic that is nowhere below 0 reaches `value`; 1 if
  // it does not.
  double WhereIntegralIs(double value) const;
};

// The cells around a place, and the place between their middles.
struct Corners {
  std::array<std::size_t, 8> cells{};  // x fastest, then y, z
  glm::ivec3 low{0};
  glm::ivec3 high{0};

  static Corners Around(const volume::RegularGrid& grid, const glm::dvec3& place_m);
  // 0 to 1 along each axis.
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

// The pieces of the ray within `span`, which is to lie in the grid's box. `direction` has the
// length 1.
std::vector<RayPiece> PiecesOf(const volume::RegularGrid& grid, const glm::dvec3& origin_m,
                               const glm::dvec3& direction, const Span& span);

}  // namespace thunderhead::scene
