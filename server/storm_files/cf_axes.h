// Reads one spatial axis of a CF file: its cells in metres and, for the height axis, how layers of
// uneven thickness are averaged onto cells of equal thickness.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/cf_names.h"

namespace thunderhead::storm_files {

// The part of a grid cell that one layer of the file fills.
struct LayerShare {
  int layer = 0;       // index of the layer, counted upwards
  double share = 0.0;  // part of the cell's height, 0 to 1
};

struct CfAxis {
  std::string dimension;
  int file_cells = 0;     // number of cells in the file
  bool reversed = false;  // true if the file's axis runs to the west, to the south or downwards
  int cells = 0;          // number of cells of the grid
  double low_m = 0.0;     // position of the first cell's lower face
  double spacing_m = 0.0;
  // For each cell of the grid, the layers that fill it. The array is empty if the cells are the
  // file's own layers.
  std::vector<std::vector<LayerShare>> shares;
  bool exact = true;  // true if no boundary between layers lies inside a cell
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

// Sets the cells of `axis` to cells of equal thickness for layers between `faces_m` (ascending).
// The thickness is the largest common divisor of the layers' thicknesses. If this gives too many
// cells, the cells are about as thick as the thinnest layer.
void EvenOut(const std::vector<double>& faces_m, CfAxis* axis);

}  // namespace thunderhead::storm_files
