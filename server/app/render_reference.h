// Renders a picture by the Monte Carlo reference for the render command. The picture is traced in
// this process on all cores.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "app/scene_file.h"
#include "reference/trace_scene.h"

namespace thunderhead::app {

// The light that the reference traces, and the limits at which it stops. If no limit is set, it
// traces kDefaultSamplesPerPixel.
struct ReferenceFlags {
  int samples_per_pixel = 0;
  double seconds = 0.0;
  double target_error = 0.0;  // relative standard error of the whole picture at which to stop
  reference::TraceOptions light;

  bool AnyLimit() const { return samples_per_pixel != 0 || seconds != 0.0 || target_error != 0.0; }
};

inline constexpr int kDefaultSamplesPerPixel = 64;

// Renders the picture and writes it to `output`. An .exr file has linear radiance and its standard
// error. A .png or .jpg file is tone mapped on `device`. Ctrl-C stops tracing early and writes the
// picture so far.
absl::Status RenderReference(const std::string& storm, const SceneFlags& scene,
                             const ReferenceFlags& limits, const std::string& output,
                             const std::string& device);

}  // namespace thunderhead::app
