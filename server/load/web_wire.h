// Parses the end of a call as the gateway sends it: as the response body of gRPC-Web, or as
// trailers in text form.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace thunderhead::load {

// Returns the call's status from a block of trailers, which has lines "name:value".
absl::Status StatusOfTrailers(std::string_view trailers);

// Returns the message of a unary call's response body, or the call's error.
absl::StatusOr<std::string> UnaryMessage(std::string_view body);

}  // namespace thunderhead::load
