// Implements `thunderhead watch` for a storm of a running server. It draws each of the storm's
// times when the server's catalogue offers it. The server's rules decide when a time is complete.
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
  // Returns whether to end once `times` are drawn.
  std::function<bool(int times)> is_over;
  // Called with the pictures of all times after new pictures were made.
  std::function<absl::Status(const std::vector<PlannedPicture>&)> after_new;
};

// Returns when the watch is over, with the worst error of any picture. Returns CANCELLED after
// `stop`, and UNAVAILABLE if the server cannot be reached for a minute.
absl::Status WatchServer(const ServerWatch& watch, ServerLink& server, PictureRun& run,
                         RunProgress& progress, const std::stop_token& stop);

}  // namespace thunderhead::app
