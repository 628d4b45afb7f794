// Finds where the columns of a GRIB grid are on Earth.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "grib/grid.h"
#include "storm_files/even_columns.h"

namespace thunderhead::storm_files {

// Returns the places of the grid's columns, for MakeEven.
ColumnPlaces PlacesOf(const grib::Grid& grid);

// Returns for each column the angle in radians, anticlockwise, from east to the direction of the
// grid's x axis. It is empty if all angles are 0. Returns INVALID_ARGUMENT if columns have no
// place.
absl::StatusOr<std::vector<float>> AxisAngles(const grib::Grid& grid);

}  // namespace thunderhead::storm_files
