// Reads files that a user names. A folder, a device or a huge file that is named by mistake gives
// an error.
#pragma once

#include <cstddef>
#include <string>

#include "absl/status/statusor.h"

namespace thunderhead::base {

// Returns the contents of the regular file at `path`, which may have at most `max_bytes`. Returns
// INVALID_ARGUMENT, which names the path and the limit, if the file cannot be read, is not a
// regular file, or is larger.
absl::StatusOr<std::string> ReadBoundedFile(const std::string& path, std::size_t max_bytes);

// Returns the same error for a file that cannot be read or is not a regular file. Of a larger file,
// returns the first `max_bytes`.
absl::StatusOr<std::string> ReadFileStart(const std::string& path, std::size_t max_bytes);

// Returns INVALID_ARGUMENT, which says that `what` has more than `max_bytes`.
absl::Status TooLarge(const std::string& what, std::size_t max_bytes);

}  // namespace thunderhead::base
