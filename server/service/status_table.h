// How the engine's status becomes gRPC's: one table, so that every rpc speaks alike.
#pragma once

#include <grpcpp/support/status.h>

#include "absl/status/status.h"

namespace thunderhead::service {

grpc::Status ToGrpcStatus(const absl::Status& status);

}  // namespace thunderhead::service
