// Support for WRF output as a format of storm files.
#pragma once

#include <memory>

#include "storm_files/storm_format.h"

namespace thunderhead::storm_files {

std::shared_ptr<const StormFormat> MakeWrfFormat();

}  // namespace thunderhead::storm_files
