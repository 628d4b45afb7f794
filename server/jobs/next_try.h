// The retry policy for pictures that could not be drawn.
#pragma once

#include <chrono>
#include <optional>

#include "absl/status/status.h"

namespace thunderhead::jobs {

struct NextTry {
  bool counts = false;  // true if the failed attempt counts towards JobBoard::kMaxAttempts
  std::chrono::milliseconds pause{0};
};

// Returns whether and when to retry a picture after the failure `why`, or nothing if it must not be
// retried. The picture was begun `attempts` times, including the failed attempt. Failures of the
// server and of hanging storage do not count as attempts, because jobs must survive them even if
// they last overnight. Other temporary failures, such as a lost device, may be caused by the
// picture itself. They count, and the pause doubles with each attempt, up to five minutes. If
// `draining` is true (the server shuts down), cancelled pictures do not count either. Returns
// nothing if a retry would not help or the attempts are used up.
std::optional<NextTry> NextTryAfter(const absl::Status& why, int attempts, bool draining);

}  // namespace thunderhead::jobs
