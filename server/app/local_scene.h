// A scene with its storm's fields, for commands that draw or trace in this process without the
// service.
#pragma once

#include <memory>
#include <stop_token>
#include <string>

#include "absl/status/statusor.h"
#include "app/scene_file.h"
#include "scene/scene.h"
#include "storm_store/storm_store.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::app {

struct LocalScene {
  std::string storm_id;
  storm_store::StormInfo storm;
  v1::Scene message;  // completed: every default filled in
  scene::Scene scene;
  std::shared_ptr<const volume::HydrometeorFields> fields;
};

// Opens the storm at `path`, completes the scene from `flags` as the service does, and reads the
// fields of its time with a progress bar. INVALID_ARGUMENT names the wrong value. CANCELLED if
// `stop` is requested.
absl::StatusOr<LocalScene> OpenScene(const std::string& path, const SceneFlags& flags,
                                     const std::stop_token& stop = {});

}  // namespace thunderhead::app
