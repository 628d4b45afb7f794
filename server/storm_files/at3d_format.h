// Cloud fields of AT3D and pyshdom as a storm format.
#pragma once

#include <memory>

#include "storm_files/storm_format.h"

namespace thunderhead::storm_files {

std::shared_ptr<const StormFormat> MakeAt3dFormat();

}  // namespace thunderhead::storm_files
