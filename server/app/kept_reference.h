// Pictures by the Monte Carlo reference, with which drawn pictures are compared. They are stored
// between runs.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "app/interruption.h"
#include "reference/trace_scene.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::app {

struct ReferenceRequest {
  std::string name;  // for the progress bar
  scene::Scene scene;
  std::string scene_text;  // text with every setting that affects the picture
  reference::TraceOptions options;
  int samples_per_pixel = 0;
};

// Returns the picture stored at `path`, if it has the same scene text, peak cut and number of
// samples. Otherwise traces a new picture and stores it there. Returns CANCELLED if it is
// interrupted, and then writes nothing.
absl::StatusOr<picture::LinearPicture> KeptReference(const ReferenceRequest& request,
                                                     const volume::HydrometeorFields& fields,
                                                     const std::string& path,
                                                     const Interruption& interruption);

}  // namespace thunderhead::app
