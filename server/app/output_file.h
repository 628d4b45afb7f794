// Files that commands write.
#pragma once

#include <string>

#include "absl/status/status.h"

namespace thunderhead::app {

// Under a name of its own first, so that a reader never sees half a file.
absl::Status WriteFile(const std::string& path, const std::string& bytes);

}  // namespace thunderhead::app
