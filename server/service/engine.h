// The objects that the handlers use: storms, sessions, the render loop, threads for blocking work,
// and generated clouds. Handlers run on gRPC's threads and must not block there.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "base/executor.h"
#include "base/wake_signal.h"
#include "drawing/render_loop.h"
#include "service/cloud_store.h"
#include "service/drain.h"
#include "service/limits.h"
#include "session/session_keeper.h"
#include "session/sessions.h"
#include "storm_store/storm_store.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::service {

class CatalogueFollower;

struct Engine {
  storm_store::StormStore& store;
  session::Sessions& sessions;
  drawing::RenderLoop& loop;
  base::WakeSignal& wake;
  base::Executor& executor;
  CloudStore& clouds;
  session::SessionKeeper* keeper;  // null if sessions end with the server
  const CatalogueFollower& catalogue;
  Drain& drain;
  Limits limits;
};

// Calls `done` after an attempt to save the changes of sessions. If sessions end with the server,
// it calls `done` at once with OK. Otherwise it calls it on another thread, as
// SessionKeeper::SaveThen does.
void SaveThen(Engine& engine, session::SessionKeeper::Done done);

// Returns the storm's fields at that time. An error names `path`, the field of the request that
// holds the storm's id.
absl::StatusOr<std::shared_ptr<const volume::HydrometeorFields>> ReadFields(
    storm_store::StormStore& store, const std::string& storm_id, int time_index,
    const std::string& path);

// Frames the condensate if the camera needs it, then calls `then`. Without framing, the call
// happens at once. Otherwise it happens on the executor after the fields were read, in the turn of
// the identity `owner`. `scene` must live until then.
void FrameThen(Engine& engine, const std::string& owner, v1::Scene& scene,
               std::function<void(const absl::Status&)> then);

}  // namespace thunderhead::service
