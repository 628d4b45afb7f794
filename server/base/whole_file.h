// Files that are read and written whole.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace thunderhead::base {

absl::StatusOr<std::string> ReadWholeFile(const std::string& path);

// Under a name of its own first, so that a reader never sees half a file.
absl::Status WriteWholeFile(const std::string& path, const std::string& bytes);

}  // namespace thunderhead::base
