// Finds the members of an ensemble in a CF file. They lie along a dimension of the fields.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "netcdf/netcdf_file.h"

namespace thunderhead::storm_files {

// Returns whether the members of an ensemble lie along a dimension. Its name says so (realization,
// member, ensemble), or a coordinate along it has the standard name realization.
bool IsMemberDimension(const netcdf::NetcdfFile& file, const std::string& dimension);

// Returns the names of the `count` members along a dimension, such as "mem05". Their numbers are
// those of the dimension's coordinate if these are whole and all different. Otherwise they count
// from 0. Returns INVALID_ARGUMENT if a file may not have so many storms.
absl::StatusOr<std::vector<std::string>> MemberNames(const netcdf::NetcdfFile& file,
                                                     const std::string& dimension,
                                                     std::size_t count);

}  // namespace thunderhead::storm_files
