// Renders a picture by the Monte Carlo reference for the render command. The picture is traced in
// this process on all cores.
#pragma once

#include <optional>
#include <string>

#include "absl/status/status.h"
#include "app/scene_file.h"
#include "reference/trace_scene.h"

namespace thunderhead::app {

// The light that the reference traces, and the limits at which it stops. If no limit is set, it
// traces kDefaultSamplesPerPixel.
struct ReferenceFlags {
  std::optional<int> samples_per_pixel;
  std::optional<double> seconds;
  std::optional<double> target_error;  // relative standard error of the whole picture
  std::optional<int> max_scatterings;  // overrides that of `light`
  reference::TraceOptions light;

  bool AnyLimit() const {
    return samples_per_pixel.has_value() || seconds.has_value() || target_error.has_value();
  }
};

inline constexpr int kDefaultSamplesPerPixel = 64;

// Renders the picture and writes it to `output`. An .exr file has linear radiance and its standard
// error. A .png or .jpg file is tone mapped on `device`. Ctrl-C stops tracing early and writes the
// picture so far.
absl::Status RenderReference(const std::string& storm, const SceneFlags& scene,
                             const ReferenceFlags& limits, const std::string& output,
                             const std::string& device);

}  // namespace thunderhead::app
