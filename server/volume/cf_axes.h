// One spatial axis of a CF file: its cells in metres and, for heights, how layers of uneven
// thickness go onto even ones. Knows no variables.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "volume/cf_names.h"
#include "volume/netcdf_file.h"

namespace thunderhead::volume {

// The part that a layer of the file has in a cell of the grid.
struct LayerShare {
  int layer = 0;       // counted upwards
  double share = 0.0;  // of the cell's height
};

struct CfAxis {
  std::string dimension;
  int file_cells = 0;     // in the file
  bool reversed = false;  // the file runs west, south or down
  int cells = 0;          // of the grid
  double low_m = 0.0;     // the face of the first cell
  double spacing_m = 0.0;
  // For each cell of the grid the layers in it; empty if they are the file's own.
  std::vector<std::vector<LayerShare>> shares;
  bool exact = true;  // no layer's face lies inside a cell
  // The middle, if the file gives degrees.
  std::optional<double> middle_deg;
};

// What a coordinate cannot tell by itself.
struct CfSizes {
  double metres_per_degree = 0.0;
  double single_cell_m = 0.0;  // width of an axis's only cell, at 0 and without bounds; 0: unknown
};

// The axis along `dimension`, from the coordinate variable of that name and its bounds. Errors name
// the coordinate and what it lacks.
absl::StatusOr<CfAxis> ReadCfAxis(const NetcdfFile& file, const std::string& dimension,
                                  CfDirection direction, const CfSizes& sizes);

// What the file says of a variable, or of a dimension without one.
CfDescription DescribeCf(const NetcdfFile& file, const std::string& variable);

// Even cells for layers between `faces_m`, which rise: as fine as the layers' common divisor where
// there is one of a sensible number, else about as fine as the thinnest layer.
void EvenOut(const std::vector<double>& faces_m, CfAxis* axis);

}  // namespace thunderhead::volume
