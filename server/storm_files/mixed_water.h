// Splits a variable that holds several hydrometeors by temperature, as the single-moment
// microphysics of SAM does (Khairoutdinov and Randall 2003, appendix). The limits of temperature
// are in SAM's source, MICRO_SAM1MOM/micro_params.f90. Cloud water has tbgmin and tbgmax, 253.16
// and 273.16 K. Rain has tprmin and tprmax, 268.16 and 283.16 K. Graupel in the rest of the
// precipitation has tgrmin and tgrmax, 223.16 and 283.16 K.
#pragma once

#include <vector>

#include "physics/hydrometeors.h"

namespace thunderhead::storm_files {

enum class MixedWater {
  kNone,           // the variable holds one hydrometeor
  kCloud,          // cloud water and cloud ice
  kPrecipitation,  // rain, snow and graupel
};

// Returns the hydrometeors that share the variable. kNone gives none.
std::vector<physics::Hydrometeor> HydrometeorsIn(MixedWater mixed);

// Returns the share of one of these hydrometeors, 0 to 1. It is NaN where the temperature is.
float ShareOf(MixedWater mixed, physics::Hydrometeor hydrometeor, float temperature_K);

}  // namespace thunderhead::storm_files
