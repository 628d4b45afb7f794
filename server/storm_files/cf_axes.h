// Reads one spatial axis of a CF file: the faces of its cells. The layers of the height axis may be
// of uneven thickness.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/cf_arrange.h"
#include "storm_files/cf_names.h"

namespace thunderhead::storm_files {

// The top of a storm's layers is at most at this height.
inline constexpr double kHighestTop_m = 200'000.0;

// The quantity along an axis.
enum class CfAxisUnit {
  kMetres,
  kDegrees,  // any angle: of the Earth, of a rotated grid or of a satellite (cf_angles.h)
  kNone,     // the axis has no coordinate that is a place; its faces are 0, 1, 2, ...
};

struct CfAxis {
  std::string dimension;
  std::string coordinate;  // empty for CfAxisUnit::kNone
  std::string counted_by;  // the coordinate that only numbers the cells; empty if none does
  int cells = 0;
  bool reversed = false;  // true if the file's axis runs to the west, to the south or downwards
  CfAxisUnit unit = CfAxisUnit::kMetres;
  double units_per_written = 1.0;  // metres or degrees in one unit of the file's coordinate
  std::vector<double> faces;       // ascending, one more than cells; evenly spaced if horizontal
  std::vector<std::string> assumptions;  // sentences for the user

  double Middle() const { return 0.5 * (faces.front() + faces.back()); }
  double Spacing() const { return (faces.back() - faces.front()) / cells; }
};

// Returns a horizontal axis. `single_cell` is the width of the axis's only cell without bounds, in
// the axis's unit; 0 if unknown. A coordinate that only numbers the cells gives an axis of
// CfAxisUnit::kNone. Errors name the coordinate and what is wrong with it.
absl::StatusOr<CfAxis> ReadHorizontalAxis(const netcdf::NetcdfFile& file,
                                          const CfDimension& dimension, CfDirection direction,
                                          double single_cell);

// Returns an axis of heights in metres, from a coordinate in a unit of length. A single layer needs
// bounds, because its thickness is not known otherwise. Heights that no storm has are an error, and
// so are numbers without units that number the levels.
absl::StatusOr<CfAxis> ReadHeightAxis(const netcdf::NetcdfFile& file, const CfDimension& dimension);

// Returns the faces of the cells around two or more ascending `centres`. Faces are evenly spaced if
// the centres are. Otherwise the lowest face is chosen so that `centres` are exactly the cells'
// centres, and thicknesses change little from cell to cell. The lowest face is then at 0, or half
// the first distance below the first centre. If neither is possible, each inner face is half-way
// between two neighbouring centres.
std::vector<double> FacesAround(const std::vector<double>& centres);

// Returns the faces of the cells of a coordinate from its CF bounds, in the coordinate's units.
// There is one more face than cells. The array is empty if there are no bounds. Bounds that are not
// contiguous are an error. Values that differ by `period` are the same place: it is 360 for degrees
// of longitude, otherwise 0.
absl::StatusOr<std::vector<double>> ReadBounds(const netcdf::NetcdfFile& file,
                                               const std::string& coordinate, std::size_t cells,
                                               double period);

// Returns the faces like ReadBounds, but from the variable `bounds`, which must exist. The
// coordinate need not rise or fall all along.
absl::StatusOr<std::vector<double>> ReadBoundsIn(const netcdf::NetcdfFile& file,
                                                 const std::string& bounds,
                                                 const std::string& coordinate, std::size_t cells,
                                                 double period);

}  // namespace thunderhead::storm_files
