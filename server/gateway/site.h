// What every connection of a gateway shares.
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
