// Makes the pictures of storms whose files or times are still arriving, each once it is complete.
#pragma once

#include <optional>
#include <stop_token>
#include <string>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "pipeline/readiness.h"
#include "runs/run_movie.h"
#include "runs/run_options.h"
#include "runs/run_progress.h"
#include "runs/server_link.h"

namespace thunderhead::runs {

// The conditions for ending the watch: after a number of files (or of times, if a server draws), or
// at a time. Whichever comes first applies. Without both, the watch never ends.
struct WatchEnd {
  std::optional<int> files;
  absl::Time at = absl::InfiniteFuture();
};

struct WatchOptions {
  std::string folder;               // the storm's id if a server draws
  std::string files = "*";          // pattern of the files' names, as in fnmatch(3)
  pipeline::ReadinessPolicy ready;  // when a file is complete
  WatchEnd end;
  PictureRunOptions pictures;
  MovieOptions movie;
  ProgressStyle progress = ProgressStyle::kAuto;
};

// Draws the folder's files in this process until the watch ends. NOT_FOUND if the folder does not
// exist. UNAVAILABLE if the time `end.at` came before every file was drawn, and DATA_LOSS if some
// files could not be drawn. Returns CANCELLED if `stop` is requested.
absl::Status RunWatch(WatchOptions options, const std::stop_token& stop);

// Draws the times of a server's storm by render jobs there, as WatchServer does. The server decides
// when a time is complete, so that `files` and `ready` are not used.
absl::Status RunWatchAtServer(WatchOptions options, ServerLink& server,
                              const std::stop_token& stop);

}  // namespace thunderhead::runs
