// Even columns of an unstructured grid, whose cells have places but no order: triangles (ICON),
// hexagons (MPAS) and the like. Each even column has the values of the nearest cell. This code does
// not depend on files.
#pragma once

#include <cstddef>
#include <string>
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

// Returns even columns with north up, whose model's columns are the cells in one row. Their
// distance is the median distance between a cell and its nearest neighbour, or larger if there
// would be more than four times as many columns as cells. A column is outside if it is farther from
// the nearest cell than 1.2 times the distance between that cell and its third nearest neighbour.
//
// INVALID_ARGUMENT if a place is missing or impossible, or if the cells cover no area. It is also
// the error for a domain so large that distances on a flat grid are wrong by more than 1 %.
absl::StatusOr<EvenColumns> MakeEvenOfCells(const CellPlaces& places);

// Returns even columns of cells on a plane without a place on Earth. `plane_m` has their centres.
// The projection of the result is empty.
absl::StatusOr<EvenColumns> MakeEvenOfPlane(const std::vector<glm::dvec2>& plane_m);

// Returns a sentence for users that says what was done with the cells.
std::string AssumptionOfCells(const EvenColumns& even);

}  // namespace thunderhead::storm_files
