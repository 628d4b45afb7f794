// Errors that nobody else is told in full: on standard error, a line each.
#pragma once

#include "absl/status/status.h"

namespace thunderhead::base {

void LogError(const absl::Status& error);

}  // namespace thunderhead::base
