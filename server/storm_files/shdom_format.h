// Particle files and property files of SHDOM and of the I3RC Monte Carlo model as a storm format.
#pragma once

#include <memory>

#include "storm_files/storm_format.h"

namespace thunderhead::storm_files {

std::shared_ptr<const StormFormat> MakeShdomFormat();

}  // namespace thunderhead::storm_files
