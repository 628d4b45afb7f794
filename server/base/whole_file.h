// Reading and writing whole files.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace thunderhead::base {

absl::StatusOr<std::string> ReadWholeFile(const std::string& path);

// Writes to a temporary name and renames, so that a reader never sees half a file.
absl::Status WriteWholeFile(const std::string& path, const std::string& bytes);

}  // namespace thunderhead::base
