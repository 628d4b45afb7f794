// Parses the ends of calls as the gateway writes them: gRPC-Web's response body, and trailers as
// text.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace thunderhead::load {

// Returns the call's status from a block of trailers, which has lines "name:value".
absl::Status StatusOfTrailers(std::string_view trailers);

// Returns the only message of a unary call's response body, or the call's error.
absl::StatusOr<std::string> UnaryMessage(std::string_view body);

}  // namespace thunderhead::load
