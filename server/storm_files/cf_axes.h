// One spatial axis of a CF file: its cells in metres and, for heights, how layers of uneven
// thickness are averaged onto even cells. This code does not interpret other variables.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/cf_names.h"

namespace thunderhead::storm_files {

// The share of a file's layer in a cell of the grid.
struct LayerShare {
  int layer = 0;       // counted upwards
  double share = 0.0;  // share of the cell's height
};

struct CfAxis {
  std::string dimension;
  int file_cells = 0;     // number of cells in the file
  bool reversed = false;  // in the file the axis runs west, south or down
  int cells = 0;          // number of cells of the grid
  double low_m = 0.0;     // the face of the first cell
  double spacing_m = 0.0;
  // For each cell of the grid, the layers in it. Empty if cells are the file's own layers.
  std::vector<std::vector<LayerShare>> shares;
  bool exact = true;  // no layer's boundary lies inside a cell
  // The coordinate of the middle, if the file gives degrees.
  std::optional<double> middle_deg;
};

// Information about an axis that its coordinate variable does not have.
struct CfSizes {
  double metres_per_degree = 0.0;
  double single_cell_m = 0.0;  // width of a single cell at 0 without bounds; 0: unknown
};

// Returns the axis along `dimension`, from the coordinate variable of that name and its bounds.
// Errors name the coordinate and what is wrong with it.
absl::StatusOr<CfAxis> ReadCfAxis(const netcdf::NetcdfFile& file, const std::string& dimension,
                                  CfDirection direction, const CfSizes& sizes);

// Returns the attributes of a variable, or of a dimension without a coordinate variable.
CfDescription DescribeCf(const netcdf::NetcdfFile& file, const std::string& variable);

// Chooses even cells for layers between `faces_m` (ascending). The cells are as thick as the
// largest common divisor of the layers' thicknesses, unless that gives too many cells. Otherwise
// they are about as thick as the thinnest layer.
void EvenOut(const std::vector<double>& faces_m, CfAxis* axis);

}  // namespace thunderhead::storm_files
