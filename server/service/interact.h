// The Interact call: a whole session in one stream each way, for clients that stay connected. Its
// messages are handled as bytes, so that a message for many people is serialized once.
#pragma once

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include <memory>

#include "access/door.h"
#include "service/engine.h"

namespace thunderhead::service {

using InteractReactor = grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>;

// Starts the call. Requests beyond `requests_per_second` are refused; 0 means no limit.
InteractReactor* Interact(Engine& engine, grpc::CallbackServerContext* context,
                          std::shared_ptr<const access::Caller> caller, double requests_per_second);

}  // namespace thunderhead::service
