// Three-dimensional cloud files of libRadtran's solver MYSTIC as a storm format.
#pragma once

#include <memory>

#include "storm_files/storm_format.h"

namespace thunderhead::storm_files {

std::shared_ptr<const StormFormat> MakeMysticFormat();

}  // namespace thunderhead::storm_files
