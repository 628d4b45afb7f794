// Opens and reads files that this program has written, in a folder in which another program may
// have replaced them by something else.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "base/file_descriptor.h"

namespace thunderhead::base {

// Opens the file at `path` for reading. Neither the file nor its folder may be a link, so that a
// planted link cannot lead to another file. Opening a pipe does not wait for its writer. Returns
// NOT_FOUND if there is no file, DATA_LOSS if there is a link or anything else that is not a
// regular file, and UNAVAILABLE for other errors.
absl::StatusOr<FileDescriptor> OpenOwnFile(const std::string& path);

// Returns the whole contents of the file at `path`. In contrast to OpenOwnFile, the folder may be a
// link, because users choose it. Errors are those of OpenOwnFile.
absl::StatusOr<std::string> ReadOwnFile(const std::string& path);

}  // namespace thunderhead::base
