// How long a netCDF file of a classic format must at least be. NetCDF-C reads what lies past the
// end of such a file as zeros, so a file cut short would show as a storm with a hole.
#pragma once

#include <cstdint>

namespace thunderhead::volume {

// The least size in bytes of the open file, from its header: the CDF-1, 2 and 5 layouts of the
// netCDF file format specification. Zero for netCDF-4, where HDF5 itself checks. The caller holds
// the lock of netCDF.
std::uintmax_t ClassicFileSize(int handle);

}  // namespace thunderhead::volume
