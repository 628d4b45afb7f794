// Errors that nobody else is told in full: a line of the log each.
#pragma once

#include "absl/status/status.h"

namespace thunderhead::base {

void LogError(const absl::Status& error);

}  // namespace thunderhead::base
