// Writes a field on a regular grid as a CF netCDF storm file. Reading it back gives the same
// values. The file is written under a temporary name and then renamed, so that a reader never sees
// an incomplete file.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::storm_files {

struct CfCloud {
  volume::RegularGrid grid;
  volume::Quantity quantity =
      volume::Quantity::kMassConcentration;  // cloud water (kg/m3), or extinction (1/m)
  std::vector<float> values;                 // grid.CellCount() values, x fastest
  std::string title;
  std::string source;   // name of the program that made the cloud
  std::string comment;  // parameters with which the cloud was made
};

// Writes the variable `lwc` (kg m-3) or `extinction` (m-1) on z, y, x in metres, compressed.
// Returns UNAVAILABLE if the file cannot be encoded or written.
absl::Status WriteCfCloud(const CfCloud& cloud, const std::string& path);

}  // namespace thunderhead::storm_files
