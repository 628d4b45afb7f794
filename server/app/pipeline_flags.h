// The flags that the commands sequence and watch share, and the options that result from them.
#pragma once

#include <string>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/status/statusor.h"
#include "app/product_files.h"
#include "app/run_progress.h"
#include "app/scene_file.h"
#include "app/server_link.h"
#include "pipeline/manifest.h"
#include "pipeline/plan.h"
#include "pipeline/product_name.h"
#include "thunderhead/v1/thunderhead.pb.h"

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
  ProgressStyle progress = ProgressStyle::kAuto;
};

void AddPipelineOptions(CLI::App& command, PipelineFlags& flags);

// A scene, and the name that the products' names use for it.
struct View {
  std::string name;
  v1::Scene scene;
  // The hash of the scene as canonical JSON and of everything else that affects the pictures.
  std::string sha256;
};

// The options that result from the flags, checked as far as is possible without a storm.
struct PictureRunOptions {
  pipeline::ProductName product;
  ProductFormat format;
  std::vector<View> views;
  std::string manifest;
  pipeline::OtherManifests other_manifests;
  std::string device;
  int jobs = 1;
  double error_seconds = 0.0;
  bool done_markers = false;
};

// Returns the options, checked. INVALID_ARGUMENT names the flag and what is wrong.
absl::StatusOr<PictureRunOptions> RunOptionsOf(const PipelineFlags& flags,
                                               const pipeline::Shard& shard);

}  // namespace thunderhead::app
