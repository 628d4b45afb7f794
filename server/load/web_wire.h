// The ends of calls as the gateway writes them: gRPC-Web's response body, and trailers as text.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace thunderhead::load {

// The call's status in a block of trailers, lines of "name:value".
absl::Status StatusOfTrailers(std::string_view trailers);

// The one message of a unary call's response body, or the call's error.
absl::StatusOr<std::string> UnaryMessage(std::string_view body);

}  // namespace thunderhead::load
