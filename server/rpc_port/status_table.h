// Converts an absl::Status to a gRPC status by one table, so that all rpcs report errors in the
// same way. Details attached by base/error_details.h become google.rpc's ErrorInfo, RetryInfo and
// BadRequest. Every error except CANCELLED has ErrorInfo. RESOURCE_EXHAUSTED and UNAVAILABLE also
// have RetryInfo unless a retry does not help, and INVALID_ARGUMENT has BadRequest.
#pragma once

#include <grpcpp/support/status.h>

#include <string>

#include "absl/status/status.h"

namespace thunderhead::rpc_port {

grpc::Status ToGrpcStatus(const absl::Status& status);

// These functions return the parts of a status for errors that are reported inside a message: the
// number in google.rpc.Code, the reason, and the text as valid UTF-8.
int CodeOf(const absl::Status& status);
std::string ReasonOf(const absl::Status& status);
std::string SendableMessage(const absl::Status& status);

}  // namespace thunderhead::rpc_port
