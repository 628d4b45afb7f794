// Restores the scenes of sessions that were saved while the server was down, perhaps by an older
// version of this program.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "drawing/frame_source.h"
#include "session/session_keeper.h"
#include "storm_store/storm_store.h"

namespace thunderhead::service {

// Checks the scene like a client's, and fills in the defaults of fields that its writer did not
// know. The storm may no longer exist; viewers of the session are then informed.
absl::StatusOr<session::DecodedScene> DecodeStoredScene(
    const storm_store::StormStore& store, const std::vector<scene::TechniqueInfo>& techniques,
    const std::string& serialized);

}  // namespace thunderhead::service
