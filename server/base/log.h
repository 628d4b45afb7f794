// Logs errors that no client is told in full, one line each.
#pragma once

#include "absl/status/status.h"

namespace thunderhead::base {

void LogError(const absl::Status& error);

}  // namespace thunderhead::base
