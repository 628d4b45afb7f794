// The Interact call: a whole session in one stream in each direction, for clients that stay
// connected. Messages are handled as bytes, so that a message for many people is serialized only
// once.
#pragma once

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include <memory>

#include "access/access_control.h"
#include "service/engine/engine.h"

namespace thunderhead::service {

using InteractReactor = grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>;

// Starts the call. Requests beyond `requests_per_second` are refused; 0 means no limit.
InteractReactor* Interact(Engine& engine, grpc::CallbackServerContext* context,
                          std::shared_ptr<const access::Caller> caller, double requests_per_second);

}  // namespace thunderhead::service
