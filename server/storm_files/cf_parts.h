// Finds out whether a netCDF file has only a part of one time of a storm. COSMO and ICON write the
// heights of half levels (HHL, z_ifc) once for a run, to a file such as lfff00000000c.nc. Their
// other files lack them.
#pragma once

#include <optional>

#include "netcdf/netcdf_file.h"
#include "storm_files/storm_file.h"

namespace thunderhead::storm_files {

// Returns whether the file has heights of half levels and no hydrometeors.
bool HasOnlyHeights(const netcdf::NetcdfFile& file);

// Returns the file's part of a time. `of` is equal for files with the same columns. A file of
// fields is a part only if it has exactly one time, no heights, and levels that are numbers.
// Returns nothing for a file that is no part.
std::optional<StormFile> PartOfCf(const netcdf::NetcdfFile& file);

}  // namespace thunderhead::storm_files
