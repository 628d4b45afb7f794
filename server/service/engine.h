// What the handlers work with: the storms, the sessions, the loop that draws, threads for work
// that blocks, and the folder for clouds. Handlers run on gRPC's threads and must not block there.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "base/executor.h"
#include "base/wake_signal.h"
#include "service/cloud_folder.h"
#include "session/render_loop.h"
#include "session/sessions.h"
#include "thunderhead/v1/thunderhead.pb.h"
#include "volume/storm_store.h"

namespace thunderhead::service {

struct Engine {
  volume::StormStore& store;
  session::Sessions& sessions;
  session::RenderLoop& loop;
  base::WakeSignal& wake;
  base::Executor& executor;
  CloudFolder& clouds;
};

// The storm of that id, or the first for an empty id. NOT_FOUND names those there are.
absl::StatusOr<const volume::StormInfo*> FindStorm(const volume::StormStore& store,
                                                   const std::string& id);

// INVALID_ARGUMENT, naming the range, if the storm has no such time. `path` is the field that
// asked.
absl::Status CheckTime(const volume::StormInfo& storm, std::uint32_t time_index,
                       const std::string& path);

// The storm's fields at that time. If they cannot be read, `path` is the field that named the
// storm.
absl::StatusOr<std::shared_ptr<const volume::HydrometeorFields>> ReadFields(
    volume::StormStore& store, const std::string& storm_id, int time_index,
    const std::string& path);

// Checks a scene (whose limits were checked) and fills in every default that needs no fields.
// `techniques` are those that can be chosen.
absl::Status PrepareScene(const volume::StormStore& store,
                          const std::vector<session::TechniqueInfo>& techniques, v1::Scene& scene);

// Frames the condensate if the camera needs it, then calls `then`: at once when nothing must be
// read, on the executor otherwise. `scene` must live until then.
void FrameThen(Engine& engine, v1::Scene& scene, std::function<void(const absl::Status&)> then);

}  // namespace thunderhead::service
