// Makes the pictures of every time of storms in every view, and movies of them. A run that was
// stopped continues where it ended.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "pipeline/plan.h"
#include "runs/run_movie.h"
#include "runs/run_options.h"
#include "runs/run_progress.h"
#include "runs/server_link.h"

namespace thunderhead::runs {

struct SequenceOptions {
  std::vector<std::string> storms;  // files or folders; ids if a server draws
  std::string times;                // in the notation of pipeline::ParseTimes
  pipeline::Shard shard;            // the share of the pictures that this process makes
  PictureRunOptions pictures;
  MovieOptions movie;
  ProgressStyle progress = ProgressStyle::kAuto;
};

// Makes the missing pictures, in this process or, if `server` is not null, by render jobs there.
// Returns the worst error of all pictures that were not made, of all files that could not be read,
// and of the movies. Returns CANCELLED if `stop` is requested.
absl::Status RunSequence(SequenceOptions options, ServerLink* server, const std::stop_token& stop);

}  // namespace thunderhead::runs
