// Changes of a session's scene, by UpdateScene or Interact.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "absl/status/statusor.h"
#include "service/engine/engine.h"

namespace thunderhead::service {

struct SceneChange {
  v1::Scene scene;
  std::optional<std::uint64_t> expected_revision;
  google::protobuf::FieldMask update_mask;  // an empty mask means the whole scene
};

// Returns the change in an UpdateSceneRequest or a SceneUpdate, which have the same fields.
template <typename Message>
SceneChange SceneChangeOf(const Message& message) {
  SceneChange change{message.scene(), std::nullopt, message.update_mask()};
  if (message.has_expected_revision()) change.expected_revision = message.expected_revision();
  return change;
}

// A session's newest scene, parsed from the bytes that the session stores.
struct ReadScene {
  std::uint64_t revision = 0;
  v1::Scene scene;
};
absl::StatusOr<ReadScene> NewestSceneOf(const session::Session& session);

// Shows a complete scene. The result is that of Session::Show.
bool ShowScene(const storm_store::StormStore& store, session::Session& session,
               std::uint64_t revision, const v1::Scene& scene);

// Completes the changed scene, shows it, and calls `done` with its revision. All this happens at
// once, or later on another thread if the storm must be read to place the camera.
//
// `may` returns OK if the caller may change the scene. It is called first. It is called again
// before the scene is shown, because control may pass to another person while the storm is read. It
// is also called when another change arrives meanwhile: a change that is no longer permitted does
// not block the other change.
//
// The change's limits must have been checked before. `owner` is the caller's identity. The errors
// passed to `done` are those of `may`, PrepareScene, CheckSize and of reading the storm. The error
// is ABORTED if the scene is not at the expected revision, or if another person has changed it
// meanwhile.
void ChangeScene(Engine& engine, const std::string& owner,
                 const std::shared_ptr<session::Session>& session, const SceneChange& change,
                 std::function<absl::Status()> may,
                 std::function<void(const absl::StatusOr<std::uint64_t>&)> done);

}  // namespace thunderhead::service
