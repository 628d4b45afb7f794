// Reading and writing whole files. A file that is written appears whole or not at all, also where
// the power goes: it is written beside its place, reaches the disk, and is then renamed.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace thunderhead::base {

absl::StatusOr<std::string> ReadWholeFile(const std::string& path);

// Where a file is written before it is whole: in the same folder, so that it can be renamed.
std::string PartialPath(std::string_view path);

// Writes the file at once. FAILED_PRECONDITION if its folder is missing or may not be written to,
// UNAVAILABLE if it cannot take the file now, such as a full disk.
absl::Status WriteWholeFile(const std::string& path, std::string_view bytes);

// The meaning of a system call's error `code` for writers of files: FAILED_PRECONDITION where a
// folder is missing or may not be written to, so that somebody has to look; UNAVAILABLE for what
// may pass, such as a full disk.
absl::Status WriteProblem(std::string_view message, int code);

// Creates the folder and those above it. Errors as WriteProblem.
absl::Status MakeFolders(const std::string& folder);

// Gives the file at PartialPath(path), which is complete, its name. Errors as above; the partial
// file is gone then.
absl::Status PublishFile(const std::string& path);

}  // namespace thunderhead::base
