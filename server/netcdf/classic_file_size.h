// Computes the minimum size of a netCDF file in a classic format, in order to detect truncated
// files. NetCDF-C reads zeros past the end of a classic file, so a truncated file would appear as a
// storm with a hole.
#pragma once

#include <cstdint>

namespace thunderhead::netcdf {

// Returns the minimum size in bytes of the open file, computed from its header by the layouts of
// CDF-1, 2 and 5 in the netCDF file format specification. Returns zero for netCDF-4, because HDF5
// itself detects truncated netCDF-4 files. The caller must hold NetcdfLock.
std::uintmax_t ClassicFileSize(int handle);

}  // namespace thunderhead::netcdf
