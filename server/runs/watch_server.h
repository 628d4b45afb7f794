// Implements `thunderhead watch` for a storm of a running server. It draws each time of the storm
// once the server's catalogue lists it. The server decides when a time's file is complete.
#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "runs/picture_run.h"
#include "runs/run_progress.h"
#include "runs/server_link.h"

namespace thunderhead::runs {

struct ServerWatch {
  std::string storm;
  // Returns true if the watch should end once `times` times are drawn.
  std::function<bool(int times)> is_over;
  // Called after new pictures were made, with the pictures of all times.
  std::function<absl::Status(const std::vector<PlannedPicture>&)> after_new;
};

// Watches until the watch is over. Then returns OK, or DATA_LOSS if some pictures can never be
// made. Returns CANCELLED if `stop` is requested. If the server cannot be reached or does not
// answer, tries again for a minute, and then returns UNAVAILABLE or DEADLINE_EXCEEDED. Any other
// error of a call ends the watch at once.
absl::Status WatchServer(const ServerWatch& watch, ServerLink& server, PictureRun& run,
                         RunProgress& progress, const std::stop_token& stop);

}  // namespace thunderhead::runs
