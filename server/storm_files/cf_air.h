// Finds the state of the air in a CF file: its density, or pressure and temperature.
#pragma once

#include <vector>

#include "absl/status/status.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/cf_metadata.h"

namespace thunderhead::storm_files {

// Finds the variables that are needed to convert mixing ratios to masses per volume, to compute
// heights, and to divide a variable between several hydrometeors. The fields and heights of
// `metadata` must be known. Errors name the variable and what to add.
absl::Status FindCfAir(const netcdf::NetcdfFile& file, const std::vector<CfDescription>& variables,
                       CfMetadata* metadata);

}  // namespace thunderhead::storm_files
