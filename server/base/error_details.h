// Details of an error for programs, beside the message for people: a reason that stays the
// same when the words change, the field of the request that is at fault, limits, when to try again.
// It travels with an absl::Status as payloads of plain text, attached where the error is made; the
// service turns it into gRPC's form (service/status_table.h). This room knows no messages.
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
  std::string field = {};        // its path in the request, e.g. "scene.fields[1].radius_m"
  std::string description = {};  // of what is wrong with the field; absent: the status' message
  std::map<std::string, std::string> metadata = {};  // e.g. "maximum" of "0.1" and "unit" of "m"
  std::optional<std::chrono::milliseconds> retry_after = {};
  bool permanent = false;  // the same request will be refused again, so that a retry does not help
};

// `status` with those details that it does not have yet: who found the error knows it best. OK
// stays OK.
absl::Status WithDetails(absl::Status status, const ErrorDetails& details);

ErrorDetails DetailsOf(const absl::Status& status);

// INVALID_ARGUMENT because of a field; the message is its path and `description`.
absl::Status InvalidField(const std::string& field, const std::string& description,
                          const std::string& reason,
                          const std::map<std::string, std::string>& metadata = {});

// UNAVAILABLE because the server stops; another may soon stand in its place.
absl::Status ShuttingDown();

// RESOURCE_EXHAUSTED for a connection beyond the limits, which is closed.
absl::Status TooManyConnections();
// The same for one whose address begins TLS too often.
absl::Status TooManyHandshakes();

}  // namespace thunderhead::base
