// ThunderheadService as gRPC calls it. It checks access for each call and dispatches the call to
// its handler (handlers.h).
#pragma once

#include <grpcpp/impl/service_type.h>

#include <memory>

#include "access/access_control.h"
#include "rpc_port/connection_calls.h"
#include "service/engine/engine.h"

namespace thunderhead::service {

// Returns the service. All arguments must outlive the service.
std::unique_ptr<grpc::Service> MakeThunderheadService(Engine& engine,
                                                      access::AccessControl& access_control,
                                                      rpc_port::ConnectionCalls& calls);

}  // namespace thunderhead::service
