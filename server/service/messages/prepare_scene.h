// Prepares a client's scene for drawing: finds the storm that it names and fills in every default.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "scene/technique_info.h"
#include "storm_store/storm_store.h"
#include "thunderhead/v1/scene.pb.h"

namespace thunderhead::service {

// The reason in errors about a storm that does not exist.
inline constexpr char kStormNotFound[] = "STORM_NOT_FOUND";

// Returns the storm with that id, or the first storm if the id is empty. The error NOT_FOUND lists
// some of the available storms. Returns UNAVAILABLE instead while the server still searches its
// folders for storms.
absl::StatusOr<storm_store::StormInfoPtr> FindStorm(const storm_store::StormStore& store,
                                                    const std::string& id);

// Returns INVALID_ARGUMENT, with the allowed range, if the storm has no time with that index.
// `path` is the request's field with the index.
absl::Status CheckTime(const storm_store::StormInfo& storm, std::uint32_t time_index,
                       const std::string& path);

// Checks a scene, and fills in every default that does not depend on the storm's fields. The
// scene's limits must have been checked before. `techniques` are the available techniques. Returns
// INVALID_ARGUMENT, or an error of FindStorm.
absl::Status PrepareScene(const storm_store::StormStore& store,
                          const std::vector<scene::TechniqueInfo>& techniques, v1::Scene& scene);

}  // namespace thunderhead::service
