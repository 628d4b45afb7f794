#include "app/local_scene.h"

#include "base/status.h"
#include "renderers/technique_registry.h"
#include "runs/local_service.h"
#include "service/messages/camera_messages.h"
#include "service/messages/limits_check.h"
#include "service/messages/prepare_scene.h"
#include "service/messages/scene_messages.h"

namespace thunderhead::app {

absl::StatusOr<LocalScene> OpenScene(const std::string& path, const SceneFlags& flags,
                                     const std::stop_token& stop) {
  LocalScene local;
  THUNDERHEAD_ASSIGN_OR_RETURN(local.message, ReadScene(flags));
  THUNDERHEAD_RETURN_IF_ERROR(service::CheckLimits(local.message));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::shared_ptr<storm_store::StormStore> store,
                               runs::OpenStorm(path, stop));
  THUNDERHEAD_RETURN_IF_ERROR(service::PrepareScene(
      *store, renderers::TechniqueRegistry::BuiltIn().Infos(), local.message));
  const auto time_index = static_cast<int>(local.message.time_index());
  THUNDERHEAD_RETURN_IF_ERROR(runs::ReadWithProgress(*store, time_index));
  local.storm_id = local.message.storm_id();
  local.storm = *store->Find(local.storm_id);
  THUNDERHEAD_ASSIGN_OR_RETURN(local.fields, store->Get(local.storm_id, time_index, {}));
  service::FrameCondensate(local.message, *local.fields);
  local.scene = service::ToScene(local.message);
  return local;
}

}  // namespace thunderhead::app
