// Checks any message against the limits in its schema (proto/thunderhead/v1/limits.proto), and
// fills in the defaults given there. Knows the options, but no message by name.
#pragma once

#include <google/protobuf/message.h>

#include "absl/status/status.h"

namespace thunderhead::service {

// INVALID_ARGUMENT names the first value outside its limits by its full path, e.g.
// "scene.fields[1].radius_m is 5; it must be between 1e-07 and 0.1 m", with details.
absl::Status CheckLimits(const google::protobuf::Message& message);

// Sets every absent number, bool and enumerator that has a default in the schema, in `message` and
// its submessages that are present.
void FillDefaults(google::protobuf::Message& message);

}  // namespace thunderhead::service
