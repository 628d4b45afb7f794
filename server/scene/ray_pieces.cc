#include "scene/ray_pieces.h"

#include <algorithm>
#include <cmath>

#include "glm/common.hpp"

namespace thunderhead::scene {

Cubic Cubic::Through(const std::array<double, 4>& values) {
  const auto& [a, b, c, d] = values;
  return {{a, -5.5 * a + 9.0 * b - 4.5 * c + d, 9.0 * a - 22.5 * b + 18.0 * c - 4.5 * d,
           4.5 * (d - a) + 13.5 * (b - c)}};
}

double Cubic::At(double u) const {
  return factors[0] + u * (factors[1] + u * (factors[2] + u * factors[3]));
}

double Cubic::Integral(double u) const {
  return u * (factors[0] + u * (factors[1] / 2.0 + u * (factors[2] / 3.0 + u * factors[3] / 4.0)));
}

double Cubic::Largest() const {
  double largest = At(1.0) > At(0.0) ? 1.0 : 0.0;
  const auto consider = [&](double u) {
    if (u > 0.0 && u < 1.0 && At(u) > At(largest)) largest = u;
  };
  // The extrema are the roots of the cubic's derivative. This formula for the roots avoids
  // cancellation.
  const double a = 3.0 * factors[3];
  const double half_b = factors[2];
  const double c = factors[1];
  const double discriminant = half_b * half_b - a * c;
  if (discriminant < 0.0) return largest;
  const double sum = -(half_b + std::copysign(std::sqrt(discriminant), half_b));
  if (a != 0.0) consider(sum / a);
  if (sum != 0.0) consider(c / sum);
  return largest;
}

double Cubic::WhereIntegralIs(double value) const {
  double low = 0.0;
  double high = 1.0;
  constexpr int kHalvings = 50;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = (low + high) / 2.0;
    (Integral(middle) < value ? low : high) = middle;
  }
  return high;
}

Corners Corners::Around(const volume::RegularGrid& grid, const glm::dvec3& place_m) {
  const glm::ivec3 last = grid.cells - 1;
  Corners corners;
  corners.low =
      glm::clamp(glm::ivec3(glm::floor((place_m - grid.low_corner_m) / grid.spacing_m - 0.5)),
                 glm::ivec3(0), glm::max(last - 1, 0));
  corners.high = glm::min(corners.low + 1, last);
  for (std::size_t i = 0; i < corners.cells.size(); ++i) {
    corners.cells[i] = grid.Offset((i & 1U) != 0 ? corners.high.x : corners.low.x,
                                   (i & 2U) != 0 ? corners.high.y : corners.low.y,
                                   (i & 4U) != 0 ? corners.high.z : corners.low.z);
  }
  return corners;
}

glm::dvec3 Corners::ShareOf(const volume::RegularGrid& grid, const glm::dvec3& place_m) const {
  return glm::clamp((place_m - grid.low_corner_m) / grid.spacing_m - 0.5 - glm::dvec3(low),
                    glm::dvec3(0.0), glm::dvec3(1.0));
}

double Linear(const CornerValues& values, const glm::dvec3& share) {
  std::array<double, 4> along_x{};
  for (std::size_t i = 0; i < along_x.size(); ++i) {
    along_x[i] = std::lerp(values[2 * i], values[2 * i + 1], share.x);
  }
  return std::lerp(std::lerp(along_x[0], along_x[1], share.y),
                   std::lerp(along_x[2], along_x[3], share.y), share.z);
}

Cubic RayPiece::Of(const CornerValues& values) const {
  std::array<double, 4> along{};
  for (std::size_t i = 0; i < along.size(); ++i) {
    along[i] = Linear(values, glm::mix(begin_share, end_share, static_cast<double>(i) / 3.0));
  }
  return Cubic::Through(along);
}

std::vector<RayPiece> PiecesOf(const volume::RegularGrid& grid, const glm::dvec3& origin_m,
                               const glm::dvec3& direction, const Span& span) {
  if (span.end_m <= span.begin_m) return {};
  // Pieces end where the ray crosses planes of cell centres.
  std::vector<double> ends_m = {span.end_m};
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) continue;
    for (int i = 0; i < grid.cells[axis]; ++i) {
      const double plane_m = grid.low_corner_m[axis] + (i + 0.5) * grid.spacing_m[axis];
      const double along_m = (plane_m - origin_m[axis]) / direction[axis];
      if (along_m > span.begin_m && along_m < span.end_m) ends_m.push_back(along_m);
    }
  }
  std::ranges::sort(ends_m);
  std::vector<RayPiece> pieces;
  pieces.reserve(ends_m.size());
  double begin_m = span.begin_m;
  for (const double end_m : ends_m) {
    if (end_m <= begin_m) continue;
    RayPiece piece{begin_m, end_m, {}};
    piece.corners = Corners::Around(grid, origin_m + (begin_m + end_m) / 2.0 * direction);
    piece.begin_share = piece.corners.ShareOf(grid, origin_m + begin_m * direction);
    piece.end_share = piece.corners.ShareOf(grid, origin_m + end_m * direction);
    pieces.push_back(piece);
    begin_m = end_m;
  }
  return pieces;
}

}  // namespace thunderhead::scene
