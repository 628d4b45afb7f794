#include "physics/hexagonal_prism.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "glm/geometric.hpp"

namespace thunderhead::physics {

using glm::dvec3;

HexagonalPrism::HexagonalPrism(double width, double length)
    : edge_(0.5 * width),
      half_length_(0.5 * length),
      side_area_(edge_ * length),
      base_area_(1.5 * std::numbers::sqrt3 * edge_ * edge_) {
  for (std::size_t face = 0; face < 6; ++face) {
    const double azimuth = (static_cast<double>(face) + 0.5) * std::numbers::pi / 3.0;
    normals_[face] = dvec3(std::cos(azimuth), std::sin(azimuth), 0.0);
    offsets_[face] = 0.5 * std::numbers::sqrt3 * edge_;
  }
  normals_[6] = dvec3(0.0, 0.0, 1.0);
  normals_[7] = dvec3(0.0, 0.0, -1.0);
  offsets_[6] = offsets_[7] = half_length_;
}

dvec3 HexagonalPrism::Edge(std::size_t corner) const {
  const double azimuth = static_cast<double>(corner % 6) * std::numbers::pi / 3.0;
  return {edge_ * std::cos(azimuth), edge_ * std::sin(azimuth), 0.0};
}

std::vector<dvec3> HexagonalPrism::Corners(std::size_t face) const {
  const dvec3 up(0.0, 0.0, half_length_);
  std::vector<dvec3> corners;
  if (face < 6) {
    return {Edge(face) - up, Edge(face + 1) - up, Edge(face + 1) + up, Edge(face) + up};
  }
  for (std::size_t corner = 0; corner < 6; ++corner) {
    corners.push_back(face == 6 ? Edge(corner) + up : Edge(5 - corner) - up);
  }
  return corners;
}

double HexagonalPrism::ProjectedArea(const dvec3& direction) const {
  double area = 0.0;
  for (std::size_t face = 0; face < kFaces; ++face) {
    area += Area(face) * std::max(-glm::dot(normals_[face], direction), 0.0);
  }
  return area;
}

dvec3 HexagonalPrism::PointOn(std::size_t face, double u, double v) const {
  const dvec3 up(0.0, 0.0, half_length_);
  if (face < 6) {
    return Edge(face) + u * (Edge(face + 1) - Edge(face)) + (2.0 * v - 1.0) * up;
  }
  // The hexagon consists of three rhombi. The sides of each rhombus are two vectors to edges 120
  // degrees apart.
  const double scaled = 3.0 * u;
  const auto rhombus = static_cast<std::size_t>(scaled);
  const dvec3 point =
      (scaled - static_cast<double>(rhombus)) * Edge(2 * rhombus) + v * Edge(2 * rhombus + 2);
  return face == 6 ? point + up : point - up;
}

HexagonalPrism::Exit HexagonalPrism::ExitOf(const dvec3& point, const dvec3& direction) const {
  Exit exit{0, std::numeric_limits<double>::infinity()};
  for (std::size_t face = 0; face < kFaces; ++face) {
    const double speed = glm::dot(normals_[face], direction);
    if (speed <= 0.0) continue;
    const double distance = (offsets_[face] - glm::dot(normals_[face], point)) / speed;
    if (distance < exit.distance) exit = {face, distance};
  }
  exit.distance = std::max(exit.distance, 0.0);
  return exit;
}

}  // namespace thunderhead::physics
