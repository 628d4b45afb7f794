// The reference's pictures that others are compared with, kept between runs.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "app/interruption.h"
#include "reference/trace_scene.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::app {

struct Truth {
  std::string name;  // for the progress bar
  scene::Scene scene;
  std::string scene_text;  // of every setting that the picture depends on
  reference::TraceOptions options;
  int samples_per_pixel = 0;
};

// The picture kept at `path` if it has the same scene text, peak cut and samples; otherwise traces
// and keeps a new one there. CANCELLED if interrupted, and then nothing is written.
absl::StatusOr<picture::LinearPicture> KeptTruth(const Truth& truth,
                                                 const volume::HydrometeorFields& fields,
                                                 const std::string& path,
                                                 const Interruption& interruption);

}  // namespace thunderhead::app
