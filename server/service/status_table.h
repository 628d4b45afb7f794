// Converts the engine's status to gRPC's by one table, so that all rpcs report errors alike.
// Details attached by base/error_details.h become google.rpc's ErrorInfo, RetryInfo and BadRequest:
// every error has the first, RESOURCE_EXHAUSTED and UNAVAILABLE the second, INVALID_ARGUMENT the
// third.
#pragma once

#include <grpcpp/support/status.h>

#include "absl/status/status.h"

namespace thunderhead::service {

grpc::Status ToGrpcStatus(const absl::Status& status);

}  // namespace thunderhead::service
