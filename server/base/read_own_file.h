// Reads files that this program has written into a folder in which another user may have replaced
// them by something else.
#pragma once

#include <string>

#include "absl/status/statusor.h"

namespace thunderhead::base {

// Returns the whole contents of the file at `path`. The file must be a regular file and no link.
// Reading a planted FIFO does not wait for its writer. In contrast to OpenOwnFile, the folder may
// be a link, because users choose it. Errors are those of OpenOwnFile.
absl::StatusOr<std::string> ReadOwnFile(const std::string& path);

}  // namespace thunderhead::base
