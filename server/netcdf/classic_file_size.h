// The minimum size of a netCDF file of a classic format. NetCDF-C reads zeros past the end of such
// a file, so a truncated file would show as a storm with a hole.
#pragma once

#include <cstdint>

namespace thunderhead::netcdf {

// The minimum size in bytes of the open file, from its header, by the layouts of CDF-1, 2 and 5 in
// the netCDF file format specification. Zero for netCDF-4, where HDF5 itself checks. The caller
// holds NetcdfLock.
std::uintmax_t ClassicFileSize(int handle);

}  // namespace thunderhead::netcdf
