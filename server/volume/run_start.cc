#include "volume/run_start.h"

#include <string>

namespace thunderhead::volume {

std::optional<absl::Time> RunStart(const StormFile& file) {
  absl::Time start;
  std::string error;
  if (!absl::ParseTime("%E4Y-%m-%d_%H:%M:%S", file.run, &start, &error)) return std::nullopt;
  return start;
}

}  // namespace thunderhead::volume
