#include "service/engine/engine.h"

#include <utility>

#include "base/error_details.h"
#include "base/guarded.h"
#include "base/status.h"
#include "service/messages/camera_messages.h"
#include "service/messages/prepare_scene.h"

namespace thunderhead::service {

void SaveThen(Engine& engine, session::SessionKeeper::Done done) {
  if (engine.keeper == nullptr) return done({});
  engine.keeper->SaveThen(std::move(done));
}

absl::StatusOr<std::shared_ptr<const volume::HydrometeorFields>> ReadFields(
    storm_store::StormStore& store, const std::string& storm_id, int time_index,
    const std::string& path) {
  auto fields = store.Get(storm_id, time_index, {});
  if (fields.ok()) return fields;
  return base::WithDetails(
      fields.status(),
      {.reason = absl::IsNotFound(fields.status()) ? kStormNotFound : "STORM_UNREADABLE",
       .field = path,
       .metadata = {{"storm_id", storm_id}}});
}

void FrameThen(Engine& engine, const std::string& owner, v1::Scene& scene,
               std::function<void(const absl::Status&)> then) {
  if (!NeedsFraming(scene)) return then(absl::OkStatus());
  // The executor is used even if the fields are in memory, because FrameCondensate searches them
  // for visible cloud. That takes too long for a thread of gRPC.
  const int time_index = static_cast<int>(scene.time_index());
  engine.executor.Submit(
      owner, [&engine, &scene, time_index, then = std::move(then)](const absl::Status& status) {
        if (!status.ok()) return then(status);
        then(base::Guarded([&]() -> absl::Status {
          THUNDERHEAD_ASSIGN_OR_RETURN(const auto fields, ReadFields(engine.store, scene.storm_id(),
                                                                     time_index, "scene.storm_id"));
          FrameCondensate(scene, *fields);
          return absl::OkStatus();
        }));
      });
}

}  // namespace thunderhead::service
