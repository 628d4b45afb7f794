// The call of clients that stay: a whole session in one stream each way. Its messages are handled
// as bytes, so that what many people are sent is serialized once.
#pragma once

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include "service/engine.h"

namespace thunderhead::service {

using InteractReactor = grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>;

InteractReactor* Interact(Engine& engine);

}  // namespace thunderhead::service
