// Shared by all connections of a gateway.
#pragma once

#include "gateway/gateway.h"
#include "gateway/http_policy.h"
#include "gateway/static_files.h"
#include "grpcpp/generic/generic_stub.h"

namespace thunderhead::gateway {

struct Site {
  GatewayOptions options;
  StaticFiles files;
  HttpPolicy policy;
  grpc::GenericStub stub;
};

}  // namespace thunderhead::gateway
