#include "storm_files/run_start.h"

#include "storm_files/date_time.h"

namespace thunderhead::storm_files {

std::optional<absl::Time> RunStart(const StormFile& file) { return ParseDateTime(file.run); }

}  // namespace thunderhead::storm_files
