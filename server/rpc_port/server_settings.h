// The settings of a gRPC server: timeouts, and limits of memory and sizes.
#pragma once

#include <grpcpp/server_builder.h>

#include <chrono>

#include "rpc_port/port_limits.h"

namespace thunderhead::rpc_port {

// The time for a peer to acknowledge a keepalive ping or sent data. Then its connection is closed.
inline constexpr std::chrono::milliseconds kKeepaliveTimeout{10'000};

// Sets the limits and timeouts of the server. Its responses have at most `max_response_bytes`.
void SetLimits(grpc::ServerBuilder& builder, const PortLimits& limits, int max_response_bytes);

}  // namespace thunderhead::rpc_port
