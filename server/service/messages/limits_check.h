// Checks any message against the limits in its schema (proto/thunderhead/v1/limits.proto), and
// fills in the defaults given there. It knows no particular message: it reads only the schema's
// field options.
#pragma once

#include <google/protobuf/message.h>

#include "absl/status/status.h"

namespace thunderhead::service {

// Returns INVALID_ARGUMENT for the first value outside its limits, named by its full path. An
// example is "scene.fields[1].radius_m is 5; it must be between 1e-07 and 0.1 m". The error also
// has details (base/error_details.h).
absl::Status CheckLimits(const google::protobuf::Message& message);

// Sets every absent number, bool and enumerator that has a default in the schema. Does so in
// `message` and in those of its submessages that are present.
void FillDefaults(google::protobuf::Message& message);

}  // namespace thunderhead::service
