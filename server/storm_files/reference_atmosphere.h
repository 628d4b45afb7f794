// The reference atmosphere of COSMO, from which its pressure PP deviates. It depends on height
// alone and is at rest (Doms and Baldauf 2018, A Description of the Nonhydrostatic Regional
// COSMO-Model, part I, section 3.1.2).
#pragma once

#include <optional>
#include <string>

#include "netcdf/netcdf_file.h"

namespace thunderhead::storm_files {

struct ReferenceAtmosphere {
  std::string variable;         // the variable that has the attributes
  double sea_level_Pa = 1e5;    // p0sl
  double sea_level_K = 288.15;  // t0sl
  // The decrease of temperature upwards for each unit of the logarithm of pressure (dt0lp, irefatm
  // 1).
  double lapse_K = 42.0;
  // True if temperature approaches sea_level_K - excess_K exponentially upwards (irefatm 2).
  bool exponential = false;
  double excess_K = 75.0;          // delta_t
  double scale_height_m = 10'000;  // h_scal

  // Returns the pressure at a height above mean sea level.
  double Pressure_Pa(double height_m) const;
};

// Reads the reference atmosphere from the attributes of a variable, which COSMO calls vcoord.
// Returns nothing if an attribute is missing or impossible.
std::optional<ReferenceAtmosphere> ReadReferenceAtmosphere(const netcdf::NetcdfFile& file);

}  // namespace thunderhead::storm_files
