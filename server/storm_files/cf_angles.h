// Decides what the angles along the x and y axes of a CF file are. Degrees and radians alone do not
// say it: they may be longitudes and latitudes, those of a rotated grid, or a satellite's scanning
// angles.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/cf_axes.h"

namespace thunderhead::storm_files {

// Returns whether the axes are longitudes and latitudes of the Earth. Both axes must be angles. An
// axis says so by its standard name, its units (degrees_east), its name (lon) or its long name. The
// field's grid mapping may say so, too. No axis may be one of a rotated grid or of a map.
bool AreEarthAngles(const netcdf::NetcdfFile& file, const std::string& field, const CfAxis& x,
                    const CfAxis& y);

// Checks that the length of a cell is known although its place is not. Degrees of a rotated grid
// are as long as those of the Earth. Returns INVALID_ARGUMENT for scanning angles and for radians
// without a name.
absl::Status CheckAnglesHaveLength(const netcdf::NetcdfFile& file, const CfAxis& x,
                                   const CfAxis& y);

// Returns a sentence for the user that says why axes of angles do not give the place on Earth.
std::string WhyAnglesAreNoPlace(const netcdf::NetcdfFile& file, const CfAxis& x, const CfAxis& y);

}  // namespace thunderhead::storm_files
