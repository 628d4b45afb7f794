// The call of clients that stay: a whole session in one stream each way. Its messages are handled
// as bytes, so that what many people are sent is serialized once.
#pragma once

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include <memory>

#include "access/door.h"
#include "service/engine.h"

namespace thunderhead::service {

using InteractReactor = grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>;

// Of its requests, those beyond `requests_per_second` are refused; 0: none.
InteractReactor* Interact(Engine& engine, grpc::CallbackServerContext* context,
                          std::shared_ptr<const access::Caller> caller, double requests_per_second);

}  // namespace thunderhead::service
