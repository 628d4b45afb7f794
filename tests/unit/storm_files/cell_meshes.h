// Unstructured grids for tests, with the centres of their cells on a plane in metres.
#pragma once

#include <cmath>
#include <vector>

#include "glm/vec2.hpp"

namespace thunderhead::testing {

struct CellMesh {
  std::vector<glm::dvec2> centres_m;
  double area_m2 = 0.0;    // of one cell
  double spacing_m = 0.0;  // between the centres of neighbouring cells
};

// Returns ICON's triangles with sides of `side_m`. They fill a rectangle around the origin.
inline CellMesh Triangles(const glm::dvec2& size_m, double side_m) {
  const double height_m = 0.5 * std::sqrt(3.0) * side_m;
  CellMesh mesh{{}, 0.5 * side_m * height_m, side_m / std::sqrt(3.0)};
  const int rows = static_cast<int>(size_m.y / height_m);
  const int halves = static_cast<int>(2.0 * size_m.x / side_m);
  for (int row = 0; row < rows; ++row) {
    for (int half = 0; half < halves; ++half) {
      const bool points_up = (row + half) % 2 == 0;
      mesh.centres_m.emplace_back(
          0.5 * side_m * (half + 0.5 - 0.5 * halves),
          height_m * (row - 0.5 * rows + (points_up ? 1.0 / 3.0 : 2.0 / 3.0)));
    }
  }
  return mesh;
}

// Returns the hexagons of MPAS, whose centres are `spacing_m` apart.
inline CellMesh Hexagons(const glm::dvec2& size_m, double spacing_m) {
  const double step_m = 0.5 * std::sqrt(3.0) * spacing_m;
  CellMesh mesh{{}, spacing_m * step_m, spacing_m};
  const int rows = static_cast<int>(size_m.y / step_m);
  const int columns = static_cast<int>(size_m.x / spacing_m);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      mesh.centres_m.emplace_back(
          spacing_m * (column - 0.5 * columns + (row % 2 == 0 ? 0.25 : 0.75)),
          step_m * (row - 0.5 * (rows - 1)));
    }
  }
  return mesh;
}

}  // namespace thunderhead::testing
