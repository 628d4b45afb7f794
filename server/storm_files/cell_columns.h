// Even columns of an unstructured grid, whose cells have places but no order: triangles (ICON),
// hexagons (MPAS) and the like. Each even column has the values of the nearest cell. This code does
// not depend on files.
#pragma once

#include <cstddef>
#include <vector>

#include "absl/status/statusor.h"
#include "glm/vec2.hpp"
#include "storm_files/even_columns.h"

namespace thunderhead::storm_files {

// The largest number of cells that is accepted.
inline constexpr std::size_t kMostCells = 20'000'000;

// The centres of cells, in any order.
struct CellPlaces {
  std::vector<double> latitude_deg;
  std::vector<double> longitude_deg;  // may jump by 360 degrees
  double radius_m = 6'371'229.0;      // of the model's Earth
};

// Returns even columns with north up. Their `model_columns` are the cells, in one row. The distance
// between even columns is the median distance between a cell and its nearest neighbour. It is
// larger if there would be more than four times as many columns as cells. A column is outside if it
// is farther from the nearest cell than 1.2 times the distance between that cell and its third
// nearest neighbour.
//
// Distances on the map are true in the middle of the domain. Elsewhere they are too long, at most
// by the factor EvenColumns::largest_scale.
//
// Returns INVALID_ARGUMENT if a place is missing or impossible, if the cells cover no area, or if
// the domain is wider than a hemisphere. Also returns it for fewer than 4 or more than kMostCells
// cells.
absl::StatusOr<EvenColumns> MakeEvenOfCells(const CellPlaces& places);

// Returns even columns of cells on a plane without a place on Earth. `plane_m` has their centres.
// The projection of the result is empty.
absl::StatusOr<EvenColumns> MakeEvenOfPlane(const std::vector<glm::dvec2>& plane_m);

}  // namespace thunderhead::storm_files
