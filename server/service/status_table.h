// How the engine's status becomes gRPC's: one table, so that every rpc speaks alike. What
// base/error_details.h attached becomes google.rpc's ErrorInfo, RetryInfo and BadRequest; every
// refusal has the first, RESOURCE_EXHAUSTED and UNAVAILABLE the second, INVALID_ARGUMENT the third.
#pragma once

#include <grpcpp/support/status.h>

#include "absl/status/status.h"

namespace thunderhead::service {

grpc::Status ToGrpcStatus(const absl::Status& status);

}  // namespace thunderhead::service
