// Recognises files that come from WRF but are not its history output, so that an error can name the
// cause. Such files are input of the model, output on pressure levels, tiles of single processes,
// and output of programs that replace the heights.
#pragma once

#include <optional>
#include <string>

#include "netcdf/netcdf_file.h"

namespace thunderhead::storm_files {

// Returns whether the file has the global attributes of a file of WRF or of its preprocessors.
bool HasWrfTitle(const netcdf::NetcdfFile& file);

// Returns whether a hydrometeor with WRF's name is on levels whose coordinate is eta, the number of
// a level between 1 at the ground and 0 at the top. Such a coordinate is not a height.
bool IsOnEta(const netcdf::NetcdfFile& file);

// Returns why the file cannot be read and what to give instead, without the file's path. Returns
// nothing for a file of no such kind.
std::optional<std::string> WhyOnlyRelated(const netcdf::NetcdfFile& file);

// Returns why the file is only a part of the domain that one process wrote, or nothing.
std::optional<std::string> WhyOnlyTile(const netcdf::NetcdfFile& file);

}  // namespace thunderhead::storm_files
