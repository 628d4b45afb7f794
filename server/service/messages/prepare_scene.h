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

// The reason of errors that name a storm that does not exist.
inline constexpr char kStormNotFound[] = "STORM_NOT_FOUND";

// Returns the storm with that id, or the first storm for an empty id. The error NOT_FOUND lists the
// storms.
absl::StatusOr<storm_store::StormInfoPtr> FindStorm(const storm_store::StormStore& store,
                                                    const std::string& id);

// Returns INVALID_ARGUMENT, which names the range, if the storm has no such time. `path` is the
// request's field.
absl::Status CheckTime(const storm_store::StormInfo& storm, std::uint32_t time_index,
                       const std::string& path);

// Checks a scene, whose limits must have been checked, and fills in every default that needs no
// fields. `techniques` are the available ones.
absl::Status PrepareScene(const storm_store::StormStore& store,
                          const std::vector<scene::TechniqueInfo>& techniques, v1::Scene& scene);

}  // namespace thunderhead::service
