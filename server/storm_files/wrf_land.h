// Finds the land-cover variables of a WRF output file.
#pragma once

#include <string>

#include "netcdf/netcdf_file.h"
#include "physics/land_use.h"
#include "storm_files/wrf_layout.h"

namespace thunderhead::storm_files {

// The names of the land-cover variables. A name is empty if the file lacks the variable.
struct WrfLand {
  physics::LandUseScheme scheme = physics::LandUseScheme::kUsgs;
  std::string land_use;
  std::string mask;  // XLAND (2 is water) or LANDMASK (0 is water)
  std::string albedo;
  std::string green;       // variable in percent
  std::string snow_share;  // variable with the snow-covered share of a cell
  std::string snow_depth;  // variable with the depth in m, used if there is no share
};

// Returns the land-cover variables of the file. Skips land use of an unknown scheme, and variables
// of unexpected shape or units. The variables may have no time.
WrfLand FindLand(const netcdf::NetcdfFile& file, const WrfLayout& layout);

}  // namespace thunderhead::storm_files
