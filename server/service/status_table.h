// Converts the engine's status to gRPC's by one table, so that all rpcs report errors alike.
// Details attached by base/error_details.h become google.rpc's ErrorInfo, RetryInfo and BadRequest:
// every error has the first, RESOURCE_EXHAUSTED and UNAVAILABLE the second, INVALID_ARGUMENT the
// third.
#pragma once

#include <grpcpp/support/status.h>

#include <string>

#include "absl/status/status.h"

namespace thunderhead::service {

grpc::Status ToGrpcStatus(const absl::Status& status);

// The same one by one, for errors that are told in a message: the code of google.rpc.Code, the
// reason, and the words as valid UTF-8.
int CodeOf(const absl::Status& status);
std::string ReasonOf(const absl::Status& status);
std::string SendableMessage(const absl::Status& status);

}  // namespace thunderhead::service
