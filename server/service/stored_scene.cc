#include "service/stored_scene.h"

#include "base/status.h"
#include "service/messages/camera_messages.h"
#include "service/messages/limits_check.h"
#include "service/messages/scene_messages.h"
#include "service/messages/technique_messages.h"

namespace thunderhead::service {

absl::StatusOr<session::DecodedScene> DecodeStoredScene(
    const storm_store::StormStore& store, const std::vector<scene::TechniqueInfo>& techniques,
    const std::string& serialized) {
  v1::Scene scene;
  if (!scene.ParseFromString(serialized) || NeedsFraming(scene)) {
    return absl::DataLossError("its scene is damaged");
  }
  THUNDERHEAD_RETURN_IF_ERROR(CheckLimits(scene));
  THUNDERHEAD_RETURN_IF_ERROR(CheckScene(scene));
  THUNDERHEAD_RETURN_IF_ERROR(CheckRendering(scene.rendering(), techniques));
  const storm_store::StormInfoPtr storm = store.Find(scene.storm_id());
  if (storm != nullptr && scene.time_index() < storm->times.size()) {
    FillSceneDefaults(scene, *storm);
  } else {
    FillDefaults(scene);
  }
  session::DecodedScene decoded{ToScene(scene), scene.SerializeAsString(), std::nullopt};
  if (storm != nullptr) decoded.domain = storm_store::DomainOf(*storm);
  return decoded;
}

}  // namespace thunderhead::service
