// The service as gRPC calls it: asks the door about every call, and dispatches it to its handler.
#pragma once

#include <grpcpp/impl/service_type.h>

#include <memory>

#include "access/door.h"
#include "service/connection_calls.h"
#include "service/engine.h"

namespace thunderhead::service {

// All must outlive it.
std::unique_ptr<grpc::Service> MakeThunderheadService(Engine& engine, access::Door& door,
                                                      ConnectionCalls& calls);

}  // namespace thunderhead::service
