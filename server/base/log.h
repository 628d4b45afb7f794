// Logs errors in full, one line each. Clients get a shorter text, because the full text may contain
// confidential names.
#pragma once

#include "absl/status/status.h"

namespace thunderhead::base {

void LogError(const absl::Status& error);

}  // namespace thunderhead::base
