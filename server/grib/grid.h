// The horizontal grid of a field: its size, place, map projection and order of points, by
// section 3.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "glm/vec2.hpp"

namespace thunderhead::grib {

// A row of cells on one parallel, from west to east.
struct CellRow {
  double latitude_deg = 0.0;
  double first_longitude_deg = 0.0;
  double step_deg = 0.0;
  int cells = 0;

  bool operator==(const CellRow&) const = default;
};

struct Grid {
  int columns = 0;  // from west to east
  int rows = 0;     // from south to north
  // The map projection in PROJ's notation, with the size of the Earth. Coordinates are degrees for
  // "+proj=longlat" and "+proj=ob_tran" (a rotated pole), and metres on the map for the others.
  std::string projection;
  glm::dvec2 south_west{0.0};  // coordinates of the centre of the south-west cell
  glm::dvec2 step{0.0};        // distances of neighbours in these coordinates
  // Names an unstructured grid: "grid 44 (uuidOfHGrid a27b8de6-...)". It is empty for a structured
  // grid. The cells are columns of one row, in the file's order. Their places are in `cell_rows`
  // or, if that is empty, in other fields of the file.
  std::string cells;
  std::vector<CellRow> cell_rows;        // of a reduced Gaussian grid, in the file's order
  bool wind_along_grid = false;          // true if winds are along x and y, false if east and north
  std::vector<std::string> assumptions;  // each one sentence

  // The order of the points in the file (code table 3.4).
  bool from_east = false;
  bool from_south = false;
  bool columns_first = false;
  bool alternates = false;

  bool operator==(const Grid&) const = default;

  bool IsUnstructured() const { return !cells.empty(); }
  std::size_t Points() const {
    return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  }
};

// Reads section 3. Returns INVALID_ARGUMENT for a kind of grid that is not supported, with its
// name, and DATA_LOSS for contradictory numbers. The errors do not name the file.
absl::StatusOr<Grid> ReadGrid(std::span<const std::byte> section3);

// Returns the values of all points, columns fastest from west to east, then rows from south to
// north. `values` has one value for each point, in the file's order.
std::vector<float> Arranged(const Grid& grid, std::vector<float> values);

}  // namespace thunderhead::grib
