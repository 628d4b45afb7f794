// The service as gRPC calls it: asks the door about every call, and dispatches it to its handler.
#pragma once

#include <grpcpp/impl/service_type.h>

#include <memory>

#include "access/door.h"
#include "service/engine.h"

namespace thunderhead::service {

// Both must outlive it.
std::unique_ptr<grpc::Service> MakeThunderheadService(Engine& engine, access::Door& door);

}  // namespace thunderhead::service
