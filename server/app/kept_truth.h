// The pictures of the reference for comparison with others, stored between runs.
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
  std::string scene_text;  // with every setting that the picture depends on
  reference::TraceOptions options;
  int samples_per_pixel = 0;
};

// Returns the picture stored at `path` if it has the same scene text, peak cut and samples.
// Otherwise traces a new one and stores it there. Returns CANCELLED if interrupted, and then writes
// nothing.
absl::StatusOr<picture::LinearPicture> KeptTruth(const Truth& truth,
                                                 const volume::HydrometeorFields& fields,
                                                 const std::string& path,
                                                 const Interruption& interruption);

}  // namespace thunderhead::app
