// Reads and validates values in Interact's requests, because clients may send anything. The
// functions use only plain values, no session.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "session/audience.h"
#include "session/roster.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::service {

// Returns `rules` with the values that the message sets.
session::Rules RulesOf(const v1::SessionRules& message, session::Rules rules);

// Returns the ray, or INVALID_ARGUMENT for a direction of length 0. `path` names the ray's field.
absl::StatusOr<session::Ray> RayOf(const v1::Ray& message, const std::string& path);

// Returns the key with which a person reconnects. Returns a new key if `key` is empty. Returns
// INVALID_ARGUMENT, which names the field `path`, for a key that no server can have issued.
absl::StatusOr<std::string> ParticipantKeyOf(const std::string& key, const std::string& path);

// Returns the name as others see it: without characters that are not printable
// (base::Printable) and surrounding white space, and cut to 40 characters. Returns
// INVALID_ARGUMENT, which names the field `path`, if it is not UTF-8.
absl::StatusOr<std::string> NameOf(const std::string& name, const std::string& path);

}  // namespace thunderhead::service
