// Finds the place of each column of an even grid among the model's columns, whose positions in the
// plane of the even grid are known.
#pragma once

#include <vector>

#include "glm/vec2.hpp"
#include "storm_files/even_columns.h"

namespace thunderhead::storm_files {

// Positions of a model's columns in the plane of a map, x fastest. In addition to the centres of
// columns they include the edges of the domain, half a column outside of the outermost centres.
// There are (columns.x + 2) * (columns.y + 2) positions.
struct ColumnMesh {
  glm::ivec2 columns{0};
  std::vector<glm::dvec2> plane_m;

  // Returns the position in columns of the i-th position along an axis with `count` columns.
  static double PositionOf(int i, int count);
  const glm::dvec2& At(int i, int j) const {
    return plane_m[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns.x + 2) +
                   static_cast<std::size_t>(i)];
  }
};

// The centres of even columns in the same plane.
struct EvenGrid {
  glm::ivec2 columns{0};
  glm::dvec2 spacing_m{0.0};
  glm::dvec2 first_m{0.0};  // centre of the south-western column
};

// Returns the place of each even column among the columns of `mesh`. Places outside of the mesh get
// the entry of the nearest place inside. The result is empty if no even column is inside, or if the
// positions of the mesh do not form a grid.
std::vector<FromColumn> PlacesAmong(const ColumnMesh& mesh, const EvenGrid& even);

// Returns the area of each column of `mesh`, as a share of `unit_m2`.
std::vector<float> AreasOf(const ColumnMesh& mesh, double unit_m2);

}  // namespace thunderhead::storm_files
