// The horizontal grid of a field: its size, place, map projection and order of points, by
// section 3.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace thunderhead::grib {

// Converts between places on Earth and the grid's own coordinates: degrees for grids of latitudes
// and longitudes, metres on the map for the others. Not safe to call from several threads.
class GridMap {
 public:
  struct Point {
    double x = 0.0;  // east along the grid
    double y = 0.0;  // north along the grid
  };
  struct Place {
    double latitude_deg = 0.0;
    double longitude_deg = 0.0;
  };

  virtual ~GridMap() = default;
  virtual Point PointOf(const Place& place) const = 0;  // NaN if the place is not on the map
  virtual Place PlaceOf(const Point& point) const = 0;

  // Returns the true length in metres of one unit of x and of y at `point`.
  virtual Point TrueLength_m(const Point& point) const = 0;
};

struct Grid {
  int columns = 0;             // from west to east
  int rows = 0;                // from south to north
  double dx_m = 0.0;           // true distance of neighbouring columns in the middle of the domain
  double dy_m = 0.0;           // and of neighbouring rows
  double latitude_deg = 0.0;   // of the middle of the domain
  double longitude_deg = 0.0;  // -180 to 180
  std::string projection;      // as PROJ writes it
  bool wind_along_grid = false;          // true if winds are along x and y, false if east and north
  std::vector<std::string> assumptions;  // each one sentence

  // The order of the points in the file (code table 3.4).
  bool from_east = false;
  bool from_south = false;
  bool columns_first = false;
  bool alternates = false;

  // The centre of the south-west cell and the distance of neighbours, in the coordinates of `map`.
  GridMap::Point south_west;
  GridMap::Point step;
  std::shared_ptr<const GridMap> map;

  std::size_t Points() const {
    return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  }
};

// Reads section 3. Errors have no path: INVALID_ARGUMENT for a kind of grid that is not read, by
// its name; DATA_LOSS for contradictory numbers.
absl::StatusOr<Grid> ReadGrid(std::span<const std::byte> section3);

// Returns the values of all points, columns fastest from west to east, then rows from south to
// north. `values` has one value for each point, in the file's order.
std::vector<float> Arranged(const Grid& grid, std::vector<float> values);

// Returns for each column the angle in radians, anticlockwise, from east to the direction of x. It
// is empty if all angles are 0.
std::vector<float> AxisAngles(const Grid& grid);

}  // namespace thunderhead::grib
