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

// The quantity along an axis.
enum class CfAxisUnit {
  kMetres,
  kDegrees,  // longitude, latitude, or an angle of a rotated grid
  kNone,     // the axis has no coordinate; its faces are 0, 1, 2, ...
};

struct CfAxis {
  std::string dimension;
  std::string coordinate;  // empty for CfAxisUnit::kNone
  int cells = 0;
  bool reversed = false;  // true if the file's axis runs to the west, to the south or downwards
  CfAxisUnit unit = CfAxisUnit::kMetres;
  double units_per_written = 1.0;  // metres or degrees in one unit of the file's coordinate
  std::vector<double> faces;       // ascending, one more than cells; even but for the height axis

  double Middle() const { return 0.5 * (faces.front() + faces.back()); }
  double Spacing() const { return (faces.back() - faces.front()) / cells; }
};

// Returns a horizontal axis. `single_cell` is the width of the axis's only cell, in the axis's
// unit, if the cell is at coordinate 0 without bounds; 0 if unknown. Errors name the coordinate and
// what is wrong with it.
absl::StatusOr<CfAxis> ReadHorizontalAxis(const netcdf::NetcdfFile& file,
                                          const CfDimension& dimension, CfDirection direction,
                                          double single_cell);

// Returns an axis of heights in metres, from a coordinate in a unit of length.
absl::StatusOr<CfAxis> ReadHeightAxis(const netcdf::NetcdfFile& file, const CfDimension& dimension);

// Returns the faces of the cells around two or more ascending `centres`. If possible, the cells
// start at 0 and `centres` are exactly their centres. Otherwise each face is half-way between two
// neighbouring centres.
std::vector<double> FacesAround(const std::vector<double>& centres);

// Returns the faces from CF bounds of a coordinate, in its units: two for each cell. The array is
// empty if there are no bounds. Bounds that are not contiguous are an error. `period` is the
// difference that means nothing: 360 for degrees of longitude, otherwise 0.
absl::StatusOr<std::vector<double>> ReadBounds(const netcdf::NetcdfFile& file,
                                               const std::string& coordinate, std::size_t cells,
                                               double period);

}  // namespace thunderhead::storm_files
