// Checks lengths in the header of a netCDF file in a classic format. NetCDF-C copies names and
// lists of dimensions to buffers of fixed lengths, NC_MAX_NAME and NC_MAX_VAR_DIMS, without
// checking their lengths in the file.
#pragma once

#include <istream>

#include "absl/status/status.h"

namespace thunderhead::netcdf {

// Reads the header by the layouts of CDF-1, 2 and 5 in the netCDF file format specification.
// Returns DATA_LOSS if a name or a list of dimensions is longer than netCDF-C's buffers, or if the
// header ends before its last entry. Returns OK for any file that is not in a classic format.
absl::Status CheckClassicHeader(std::istream& file);

}  // namespace thunderhead::netcdf
