// Checks files that the operator names before they are read.
#pragma once

#include <string>

#include "absl/status/status.h"

namespace thunderhead::base {

// Returns FAILED_PRECONDITION if there is something other than a regular file at the path, such as
// a pipe, whose opening could hang. A link to a regular file is accepted. Returns OK if nothing can
// be found there, because reading it says why.
absl::Status CheckRegularFile(const std::string& path);

}  // namespace thunderhead::base
