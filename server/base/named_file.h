// Reads files that a user names. A folder, a device or a huge file that is named by mistake gives
// an error. A pipe is read, so that the output of another program can stand for a file.
#pragma once

#include <cstddef>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace thunderhead::base {

// Returns the contents of the file or pipe at `path`, which may have at most `max_bytes`. A pipe is
// read until its writers have closed it. A FIFO without a writer is empty. Returns
// INVALID_ARGUMENT, which names the path and the limit, if the file cannot be read, is neither a
// regular file nor a pipe, or has more than `max_bytes`.
absl::StatusOr<std::string> ReadBoundedFile(const std::string& path, std::size_t max_bytes);

// Returns the contents of the regular file at `path`, or of one to which a link leads. A pipe is an
// error, and opening it does not wait. Otherwise like ReadBoundedFile.
absl::StatusOr<std::string> ReadRegularFile(const std::string& path, std::size_t max_bytes);

// Returns the first `max_bytes` of a larger file. Otherwise like ReadBoundedFile.
absl::StatusOr<std::string> ReadFileStart(const std::string& path, std::size_t max_bytes);

// Returns INVALID_ARGUMENT, which says that `what` has more than `max_bytes`.
absl::Status TooLarge(const std::string& what, std::size_t max_bytes);

// Returns whether something other than a regular file is at the path, such as a folder, a pipe or a
// device. Links are followed. Returns false if nothing can be found there.
bool IsOtherThanRegularFile(const std::string& path);

// Returns FAILED_PRECONDITION if something other than a regular file is at the path, such as a
// pipe, whose opening could hang. A link to a regular file is accepted. Returns OK if nothing can
// be found there, because reading it says why.
absl::Status CheckRegularFile(const std::string& path);

}  // namespace thunderhead::base
