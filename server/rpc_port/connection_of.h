// Tells on which connection a call came.
#pragma once

#include <grpcpp/server_context.h>

#include <optional>
#include <string>

namespace thunderhead::rpc_port {

// Returns the remote end of the call's connection, such as "1.2.3.4:80" or "[::1]:80". Returns
// nothing for the local socket.
std::optional<std::string> ConnectionOf(const grpc::ServerContextBase& context);

}  // namespace thunderhead::rpc_port
