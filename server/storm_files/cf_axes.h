// Reads one spatial axis of a CF file: its cells in metres. The layers of the height axis may be of
// uneven thickness.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/cf_names.h"

namespace thunderhead::storm_files {

struct CfAxis {
  std::string dimension;
  int cells = 0;
  bool reversed = false;  // true if the file's axis runs to the west, to the south or downwards
  std::vector<double> faces_m;  // ascending, one more than cells; even but for the height axis
  double spacing_m = 0.0;       // mean distance between faces
  // The coordinate of the axis's middle in degrees, if the file's coordinate is in degrees.
  std::optional<double> middle_deg;
};

// Information that is needed to read an axis, but that its coordinate variable does not contain.
struct CfSizes {
  double metres_per_degree = 0.0;
  double single_cell_m = 0.0;  // width of an axis's only cell if the cell is at coordinate 0
                               // without bounds; 0 if unknown
};

// Returns the axis along `dimension`, from the coordinate variable of that name and its bounds.
// Errors name the coordinate and what is wrong with it.
absl::StatusOr<CfAxis> ReadCfAxis(const netcdf::NetcdfFile& file, const std::string& dimension,
                                  CfDirection direction, const CfSizes& sizes);

// Returns the attributes of a variable, or of a dimension without a coordinate variable.
CfDescription DescribeCf(const netcdf::NetcdfFile& file, const std::string& variable);

}  // namespace thunderhead::storm_files
