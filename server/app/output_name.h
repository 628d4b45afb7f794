// Checks of the names of files that a command writes.
#pragma once

#include <initializer_list>
#include <string>

#include "absl/status/status.h"

namespace thunderhead::app {

// Checks that the name of the file to write has one of the endings, in any case, such as ".nc".
// INVALID_ARGUMENT names `flag` and the endings. Two outputs of a command have different endings,
// so that they cannot be the same file.
absl::Status CheckEnding(const std::string& flag, const std::string& path,
                         std::initializer_list<const char*> endings);

// Checks that the file to write would not replace the storm file that the command reads.
// INVALID_ARGUMENT names `flag`.
absl::Status CheckNotInput(const std::string& flag, const std::string& path,
                           const std::string& storm);

}  // namespace thunderhead::app
