// The options of a run that makes pictures: its views, its products, and where they are recorded.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pipeline/manifest.h"
#include "pipeline/product_name.h"
#include "runs/product_files.h"
#include "thunderhead/v1/scene.pb.h"

namespace thunderhead::runs {

// A scene, and the name that the products' names use for it.
struct View {
  std::string name;
  v1::Scene scene;
  // The hash of the scene as canonical JSON and of everything else that affects the pictures.
  std::string sha256;
};

// The options of a run, checked as far as is possible without a storm.
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

// Returns the name of a view whose scene is in `file`: the file's name, in a form that can be part
// of a product's name.
std::string ViewNameOf(const std::string& file);

// Returns the view with that scene. INVALID_ARGUMENT if the scene is beyond its limits, or if runs
// cannot draw it.
absl::StatusOr<View> MakeView(const std::string& name, v1::Scene scene);

// Adds the settings of the format to the view's hash. INVALID_ARGUMENT if the view cannot be saved
// in this format.
absl::Status AddFormat(const ProductFormat& format, View& view);

// Returns the other manifests in the manifest's folder. Products that they record need not be drawn
// again. If `takes_over` is true (a run of all pictures), the manifests of shares are merged into
// this one.
pipeline::OtherManifests OtherManifestsOf(const std::string& manifest, bool takes_over);

}  // namespace thunderhead::runs
