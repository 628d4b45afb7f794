// Checks any message against the limits in its schema (proto/thunderhead/v1/limits.proto), and
// fills in the defaults given there. It reads only the options and refers to no message by name.
#pragma once

#include <google/protobuf/message.h>

#include "absl/status/status.h"

namespace thunderhead::service {

// Returns INVALID_ARGUMENT, which names the first value outside its limits by its full path. An
// example is "scene.fields[1].radius_m is 5; it must be between 1e-07 and 0.1 m". The error has
// details.
absl::Status CheckLimits(const google::protobuf::Message& message);

// Sets every absent number, bool and enumerator that has a default in the schema, in `message` and
// in its submessages that are present.
void FillDefaults(google::protobuf::Message& message);

}  // namespace thunderhead::service
