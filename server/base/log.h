// Logs errors whose full text no client may see, one line each.
#pragma once

#include "absl/status/status.h"

namespace thunderhead::base {

void LogError(const absl::Status& error);

}  // namespace thunderhead::base
