// The flags that sequence and watch share, and what they mean.
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
  std::string manifest;  // empty: in the products' folder
  std::string movie;     // empty: none
  ServerFlags server;    // without an address: in this process
  std::string device = "auto";
  int jobs = 2;
  double error_seconds = 0.0;  // of tracing, for each picture's error to be measured
  bool done_markers = false;
  ProductFlags files;
  ProgressStyle progress = ProgressStyle::kAuto;
};

void AddPipelineOptions(CLI::App& command, PipelineFlags& flags);

// A scene under the name that products have for it.
struct View {
  std::string name;
  v1::Scene scene;
  // Of the scene, as canonical JSON, and with it of what else goes into the pictures.
  std::string sha256;
};

// The flags, checked as far as they can be without a storm.
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

// INVALID_ARGUMENT names the flag and what is wrong.
absl::StatusOr<PictureRunOptions> RunOptionsOf(const PipelineFlags& flags,
                                               const pipeline::Shard& shard);

}  // namespace thunderhead::app
