// Says which fields a GRIB file has, for messages about a file that lacks some.
#pragma once

#include <string>

#include "grib/index.h"

namespace thunderhead::storm_files {

// Returns the fields that a storm uses, with the number of their levels, and those that every storm
// needs and that are not on two levels: "it has cloud on 50 levels and specific humidity (0/1/0) on
// 50 levels, and no temperature (0/0/0) on two levels".
std::string SummaryOfGrib(const grib::Index& index);

}  // namespace thunderhead::storm_files
