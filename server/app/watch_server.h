// `thunderhead watch` on a storm of a running server: draws each of its times as the server's
// catalogue offers it, complete by the server's rules.
#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "app/picture_run.h"
#include "app/run_progress.h"
#include "app/server_link.h"

namespace thunderhead::app {

struct ServerWatch {
  std::string storm;
  // Whether to end, once `times` are drawn.
  std::function<bool(int times)> is_over;
  // Called with the pictures of all times after new ones were made.
  std::function<absl::Status(const std::vector<PlannedPicture>&)> after_new;
};

// Returns when it is over, with the worst that happened to a picture; CANCELLED after `stop`. A
// server that cannot be reached for a minute is UNAVAILABLE.
absl::Status WatchServer(const ServerWatch& watch, ServerLink& server, PictureRun& run,
                         RunProgress& progress, const std::stop_token& stop);

}  // namespace thunderhead::app
