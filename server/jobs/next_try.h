// The retry policy for a picture that could not be drawn.
#pragma once

#include <chrono>
#include <optional>

#include "absl/status/status.h"

namespace thunderhead::jobs {

struct NextTry {
  bool counts = false;  // counts as one of the picture's own attempts
  std::chrono::milliseconds pause{0};
};

// Returns how to retry a picture after the failure `why`. It was begun `attempts` times, including
// this one. Failures of the server and of hanging storage do not count, however long they last,
// because jobs that run overnight wait for them. Other failures with a retry time may be the
// picture's own fault, such as losing the device. They count, and their pauses double up to five
// minutes. None if a retry would not help or the last attempt was made.
std::optional<NextTry> NextTryAfter(const absl::Status& why, int attempts, bool draining);

}  // namespace thunderhead::jobs
