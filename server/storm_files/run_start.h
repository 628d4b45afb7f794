// When the run began that a storm file is of.
#pragma once

#include <optional>

#include "absl/time/time.h"
#include "storm_files/storm_file.h"

namespace thunderhead::storm_files {

// Nothing if the file does not tell: only WRF's files do so far (SIMULATION_START_DATE).
std::optional<absl::Time> RunStart(const StormFile& file);

}  // namespace thunderhead::storm_files
