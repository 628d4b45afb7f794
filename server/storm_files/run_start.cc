#include "storm_files/run_start.h"

#include <string_view>

#include "storm_files/date_time.h"

namespace thunderhead::storm_files {

// Formats may add more behind a comma, to tell runs apart.
std::optional<absl::Time> RunStart(const StormFile& file) {
  return ParseDateTime(std::string_view(file.run).substr(0, file.run.find(',')));
}

}  // namespace thunderhead::storm_files
