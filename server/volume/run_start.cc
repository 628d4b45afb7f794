#include "volume/run_start.h"

#include "volume/date_time.h"

namespace thunderhead::volume {

std::optional<absl::Time> RunStart(const StormFile& file) { return ParseDateTime(file.run); }

}  // namespace thunderhead::volume
