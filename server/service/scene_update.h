// Changes to a session's scene, however they arrive.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "absl/status/statusor.h"
#include "service/engine.h"

namespace thunderhead::service {

struct SceneChange {
  v1::Scene scene;
  std::optional<std::uint64_t> expected_revision;
  google::protobuf::FieldMask update_mask;  // no path: the whole scene
};

// The change of an UpdateSceneRequest or a SceneUpdate, which have the same fields.
template <typename Message>
SceneChange SceneChangeOf(const Message& message) {
  SceneChange change{message.scene(), std::nullopt, message.update_mask()};
  if (message.has_expected_revision()) change.expected_revision = message.expected_revision();
  return change;
}

// A session's newest scene, read back from the bytes that the session keeps.
struct ReadScene {
  std::uint64_t revision = 0;
  v1::Scene scene;
};
absl::StatusOr<ReadScene> NewestSceneOf(const session::Session& session);

// As Session::Show, of a scene that is complete.
bool ShowScene(const storm_store::StormStore& store, session::Session& session,
               std::uint64_t revision, const v1::Scene& scene);

// Completes the changed scene and shows it, then calls `done` with its revision: at once, or on
// another thread if the storm must be read to place the camera. `may` says whether who asks may
// change the scene. It is called first; as control may pass on during the read, before the scene is
// shown; and when another change comes meanwhile, which this one does not stand in the way of once
// it may not be made any more. The change's limits were checked. `owner` is the identity that asks.
// INVALID_ARGUMENT and NOT_FOUND as PrepareScene; ABORTED if the scene is at another revision.
void ChangeScene(Engine& engine, const std::string& owner,
                 const std::shared_ptr<session::Session>& session, const SceneChange& change,
                 std::function<absl::Status()> may,
                 std::function<void(const absl::StatusOr<std::uint64_t>&)> done);

}  // namespace thunderhead::service
