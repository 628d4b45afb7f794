// Lengths in the header of a netCDF file of a classic format. NetCDF-C copies names and lists of
// dimensions to buffers of NC_MAX_NAME and NC_MAX_VAR_DIMS, however long they are in the file.
#pragma once

#include <istream>

#include "absl/status/status.h"

namespace thunderhead::netcdf {

// Reads the header, by the layouts of CDF-1, 2 and 5 in the netCDF file format specification.
// DATA_LOSS if a name or a list of dimensions is longer than netCDF-C's buffers, or the header ends
// before its last entry. Whatever is not of a classic format is passed.
absl::Status CheckClassicHeader(std::istream& file);

}  // namespace thunderhead::netcdf
