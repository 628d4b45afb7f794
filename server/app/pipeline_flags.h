// The flags that sequence and watch share, and their meaning.
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
  std::vector<std::string> views;  // scene files
  std::string product;
  std::string manifest;  // if empty, in the products' folder
  std::string movie;     // empty for none
  ServerFlags server;    // without an address, the service runs in this process
  std::string device = "auto";
  int jobs = 2;
  double error_seconds = 0.0;  // of path tracing, to measure each picture's error
  bool done_markers = false;
  ProductFlags files;
  ProgressStyle progress = ProgressStyle::kAuto;
};

void AddPipelineOptions(CLI::App& command, PipelineFlags& flags);

// A scene with the name that products use for it.
struct View {
  std::string name;
  v1::Scene scene;
  // The hash of the scene as canonical JSON, and of everything else that affects the pictures.
  std::string sha256;
};

// The flags, checked as far as is possible without a storm.
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

// Returns the checked options. The error INVALID_ARGUMENT names the flag and what is wrong.
absl::StatusOr<PictureRunOptions> RunOptionsOf(const PipelineFlags& flags,
                                               const pipeline::Shard& shard);

}  // namespace thunderhead::app
