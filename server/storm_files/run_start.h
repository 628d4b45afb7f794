// Determines when the model run that wrote a storm file began.
#pragma once

#include <optional>

#include "absl/time/time.h"
#include "storm_files/storm_file.h"

namespace thunderhead::storm_files {

// Returns nothing if the file does not contain the start. WRF files (SIMULATION_START_DATE) and
// GRIB files contain it.
std::optional<absl::Time> RunStart(const StormFile& file);

}  // namespace thunderhead::storm_files
