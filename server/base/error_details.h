// Machine-readable details of an error, in addition to its message. They hold a reason code that
// stays the same when the message changes, the invalid request field, limits, and when to retry.
// The code that makes an absl::Status attaches the details to it as plain-text payloads. The
// service converts them to gRPC's form (rpc_port/status_table.h). This library does not depend on
// the API's messages.
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>

#include "absl/status/status.h"

namespace thunderhead::base {

// Each part may be absent.
struct ErrorDetails {
  std::string reason = {};       // UPPER_SNAKE_CASE
  std::string field = {};        // path of the invalid field in the request, e.g.
                                 // "scene.fields[1].radius_m"
  std::string description = {};  // what is wrong with the field; if empty, the status's message
                                 // describes it
  std::map<std::string, std::string> metadata = {};  // e.g. {"maximum", "0.1"} and {"unit", "m"}
  std::optional<std::chrono::milliseconds> retry_after = {};
  bool permanent = false;  // the same request will be refused again, so a retry does not help
};

// Returns `status` with the details that it does not have yet. Details that `status` already has
// stay, because the code that found the error knows most about the error. OK stays OK.
absl::Status WithDetails(absl::Status status, const ErrorDetails& details);

ErrorDetails DetailsOf(const absl::Status& status);

// Returns INVALID_ARGUMENT for a field. The message is the field's path and `description`.
absl::Status InvalidField(const std::string& field, const std::string& description,
                          const std::string& reason,
                          const std::map<std::string, std::string>& metadata = {});

// Returns UNAVAILABLE with the reason SHUTTING_DOWN, for requests to a server that is stopping.
absl::Status ShuttingDown();

// Returns RESOURCE_EXHAUSTED. The server sends this error on a connection that exceeds the limits,
// before it closes the connection.
absl::Status TooManyConnections();
// Returns the same error for a client address that starts TLS handshakes too often.
absl::Status TooManyHandshakes();
// Returns the same error for a client address that begins calls of gRPC's port too often.
absl::Status TooManyCalls();

}  // namespace thunderhead::base
