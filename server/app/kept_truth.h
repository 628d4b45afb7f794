// Pictures by the reference that others are measured against, kept between runs.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "app/interruption.h"
#include "reference/trace_scene.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::app {

struct Truth {
  std::string name;  // what the progress bar says is traced
  scene::Scene scene;
  std::string scene_text;  // of all of the scene that the picture depends on
  reference::TraceOptions options;
  int samples_per_pixel = 0;
};

// The picture kept at `path` if it is of the same text, peak cut and samples, else a new one, which
// is then kept there. CANCELLED if it was interrupted; nothing is kept of it.
absl::StatusOr<picture::LinearPicture> KeptTruth(const Truth& truth,
                                                 const volume::HydrometeorFields& fields,
                                                 const std::string& path,
                                                 const Interruption& interruption);

}  // namespace thunderhead::app
