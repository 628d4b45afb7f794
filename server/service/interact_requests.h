// Values from the requests of Interact, checked, since anybody may send anything. They need no
// session, only its plain values.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "session/audience.h"
#include "session/roster.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::service {

// `rules` with those of the message that are set.
session::Rules RulesOf(const v1::SessionRules& message, session::Rules rules);

// INVALID_ARGUMENT for a direction of length 0; `path` names the ray's field.
absl::StatusOr<session::Ray> RayOf(const v1::Ray& message, const std::string& path);

// The key that a person comes back with, or a new one if it is empty. INVALID_ARGUMENT, naming the
// field `path`, for what no server has given.
absl::StatusOr<std::string> ParticipantKeyOf(const std::string& key, const std::string& path);

// The name as others see it: without control characters, white space at its ends and what is beyond
// 40 characters. INVALID_ARGUMENT, naming the field `path`, if it is not UTF-8.
absl::StatusOr<std::string> NameOf(const std::string& name, const std::string& path);

}  // namespace thunderhead::service
