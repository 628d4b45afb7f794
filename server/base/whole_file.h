// Reads and writes whole files. A written file appears completely or not at all, even after a power
// failure. For this purpose the file is written under a temporary name in the same folder, flushed
// to the disk, and then renamed. A file may replace a regular file or a link to one, but nothing
// else: a device, FIFO, socket or folder at its path is an error and stays. A link is replaced and
// not followed.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace thunderhead::base {

// Returns the bytes of the file, or NOT_FOUND if it cannot be opened.
absl::StatusOr<std::string> ReadWholeFile(const std::string& path);

// Returns the temporary path under which the file at `path` is written until it is complete. The
// path is in the same folder, so that the complete file can be renamed.
std::string PartialPath(std::string_view path);

// Makes an empty file at PartialPath(path) and returns that path. Replaces anything there that is
// not a regular file with one hard link, such as a planted link or FIFO. Returns
// FAILED_PRECONDITION if the file could not replace what is at `path`. Other errors are those of
// WriteProblem.
absl::StatusOr<std::string> StartPartial(const std::string& path);

// Writes the whole file. Returns FAILED_PRECONDITION if its folder is missing or not writable, or
// if it cannot replace what is at `path`.
// Returns UNAVAILABLE if the file cannot be written now, for example because the disk is full.
absl::Status WriteWholeFile(const std::string& path, std::string_view bytes);

// Converts the error `code` of a system call to a status for code that writes files. Returns
// FAILED_PRECONDITION if an operator has to act, because a folder is missing or not writable.
// Returns UNAVAILABLE for conditions that may pass, such as a full disk.
absl::Status WriteProblem(std::string_view message, int code);

// Creates the folder and its parents. Errors are those of WriteProblem.
absl::Status MakeFolders(const std::string& folder);

// Renames the complete file at PartialPath(path) to `path`. Errors are those of WriteWholeFile.
// After an error the partial file no longer exists.
absl::Status PublishFile(const std::string& path);

}  // namespace thunderhead::base
