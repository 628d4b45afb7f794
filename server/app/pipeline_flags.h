// The flags that the commands sequence and watch share, and the options that result from them.
#pragma once

#include <string>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/status/statusor.h"
#include "app/product_flags.h"
#include "app/scene_file.h"
#include "app/server_flags.h"
#include "pipeline/plan.h"
#include "runs/run_movie.h"
#include "runs/run_options.h"
#include "runs/run_progress.h"

namespace thunderhead::app {

struct PipelineFlags {
  SceneFlags scene;
  std::vector<std::string> views;  // paths of scene files
  std::string product;
  std::string manifest;  // path of the manifest; if empty, a file in the products' folder
  std::string movie;     // name template of movies; empty for no movie
  ServerFlags server;    // if its address is empty, the service runs in this process
  std::string device = "auto";
  int jobs = 2;
  // Maximum seconds of path tracing to measure the error of each picture.
  double error_seconds = 0.0;
  bool done_markers = false;
  ProductFlags files;
  runs::ProgressStyle progress = runs::ProgressStyle::kAuto;
};

void AddPipelineOptions(CLI::App& command, PipelineFlags& flags);

// Returns the options, checked. INVALID_ARGUMENT names the flag and what is wrong.
absl::StatusOr<runs::PictureRunOptions> RunOptionsOf(const PipelineFlags& flags,
                                                     const pipeline::Shard& shard);

// Returns the movie options. INVALID_ARGUMENT if --movie is not a valid name of a movie, or if
// movies cannot be made from products of `format`.
absl::StatusOr<runs::MovieOptions> MovieOptionsOf(const PipelineFlags& flags,
                                                  const runs::ProductFormat& format);

}  // namespace thunderhead::app
