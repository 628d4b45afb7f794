// Restores the scenes of stored sessions after a restart. They may have been stored by an older
// version of this program.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "drawing/frame_source.h"
#include "session/session_keeper.h"
#include "storm_store/storm_store.h"

namespace thunderhead::service {

// Checks the scene like a scene from a client, and fills in the defaults of fields that did not
// exist yet in the version that stored the scene. Returns DATA_LOSS if the bytes are damaged, and
// INVALID_ARGUMENT if this version does not allow the scene. The scene's storm may no longer exist;
// the session's viewers are then informed by a Problem.
absl::StatusOr<session::DecodedScene> DecodeStoredScene(
    const storm_store::StormStore& store, const std::vector<scene::TechniqueInfo>& techniques,
    const std::string& serialized);

}  // namespace thunderhead::service
