// The policy by which a picture that could not be drawn is tried again.
#pragma once

#include <chrono>
#include <optional>

#include "absl/status/status.h"

namespace thunderhead::jobs {

struct NextTry {
  bool counts = false;  // as one of the picture's own attempts
  std::chrono::milliseconds pause{0};
};

// After the failure `why` of a picture begun `attempts` times, this one included. Failures of the
// server and a storage that hangs do not count, however long they last: a night's job waits for
// them. Others that say when to try again may be the picture's own, such as one that loses the
// device, and count; their pauses double up to five minutes. Nothing where another try does not
// help, or the last one was made.
std::optional<NextTry> NextTryAfter(const absl::Status& why, int attempts, bool draining);

}  // namespace thunderhead::jobs
