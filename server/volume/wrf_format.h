// WRF output as a format of storm files.
#pragma once

#include <memory>

#include "volume/storm_format.h"

namespace thunderhead::volume {

std::shared_ptr<const StormFormat> MakeWrfFormat();

}  // namespace thunderhead::volume
