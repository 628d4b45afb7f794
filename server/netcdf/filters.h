// Names the compression filters of HDF5 that files need and that may not be installed.
#pragma once

#include <string>

namespace thunderhead::netcdf {

// Returns the name of a filter by its number in HDF5's registry, with the package that has its
// plug-in: "bzip2 (HDF5 filter 307; Debian package hdf5-filter-plugin)".
std::string NameOfFilter(unsigned id);

// Returns the name of the first filter that the variable needs and that is not available. It is
// empty if there is none. The caller must hold NetcdfLock.
std::string LackingFilter(int group, int variable);

}  // namespace thunderhead::netcdf
