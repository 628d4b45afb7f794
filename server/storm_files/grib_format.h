// GRIB2 files of weather centres as a storm format.
#pragma once

#include <memory>

#include "storm_files/storm_format.h"

namespace thunderhead::storm_files {

std::shared_ptr<const StormFormat> MakeGribFormat();

}  // namespace thunderhead::storm_files
