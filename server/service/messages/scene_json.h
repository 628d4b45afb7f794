// Reads scenes as Protobuf JSON: files that a user wrote, and the texts inside pictures.
#pragma once

#include <cstddef>
#include <string>

#include "absl/status/statusor.h"
#include "thunderhead/v1/scene.pb.h"

namespace thunderhead::service {

// Maximum length of a scene's JSON. A server accepts requests of up to 1 MiB (--max-message), and a
// scene is hardly larger as a message than as JSON.
inline constexpr std::size_t kMaxSceneJson_bytes = 512 << 10;

// Returns the scene of the JSON. In contrast to Protobuf's own parser, this function refuses texts
// that are not exactly JSON (RFC 8259), names that an object has twice, and more than 100 levels of
// nesting. INVALID_ARGUMENT says what is wrong, and if possible in which line and column.
absl::StatusOr<v1::Scene> SceneOfJson(const std::string& json);

}  // namespace thunderhead::service
