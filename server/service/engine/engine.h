// The objects that the handlers of the rpcs use: storms, sessions, the render loop, threads for
// blocking work, and generated clouds. Handlers run on gRPC's threads and must not block there.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "access/access_control.h"
#include "base/executor.h"
#include "base/wake_signal.h"
#include "drawing/render_loop.h"
#include "rpc_port/drain.h"
#include "service/engine/cloud_store.h"
#include "service/engine/limits.h"
#include "session/session_keeper.h"
#include "session/sessions.h"
#include "storm_store/storm_store.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::service {

class CatalogueFollower;

// The caller of an rpc, as its handler gets it.
using CallerRef = std::shared_ptr<const access::Caller>;

struct Engine {
  storm_store::StormStore& store;
  session::Sessions& sessions;
  drawing::RenderLoop& loop;
  base::WakeSignal& wake;
  base::Executor& executor;
  CloudStore& clouds;
  session::SessionKeeper* keeper;  // null if sessions are not saved
  const CatalogueFollower& catalogue;
  rpc_port::Drain& drain;
  Limits limits;
};

// Calls `done` after an attempt to save the changes of sessions. If sessions are not saved, calls
// `done` at once with OK. Otherwise `done` is called on another thread, as by
// SessionKeeper::SaveThen.
void SaveThen(Engine& engine, session::SessionKeeper::Done done);

// Returns the storm's fields at that time. Errors name `path`, the field of the request that holds
// the storm's id.
absl::StatusOr<std::shared_ptr<const volume::HydrometeorFields>> ReadFields(
    storm_store::StormStore& store, const std::string& storm_id, int time_index,
    const std::string& path);

// If the camera's defaults depend on the storm, sets them so that the condensate is framed. Then
// calls `then`: immediately if no framing is needed, otherwise on the executor after the fields
// were read. The executor does the work in the turn of the identity `owner`. `scene` must live
// until `then` is called.
void FrameThen(Engine& engine, const std::string& owner, v1::Scene& scene,
               std::function<void(const absl::Status&)> then);

}  // namespace thunderhead::service
