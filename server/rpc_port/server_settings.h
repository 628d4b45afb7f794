// The settings of a gRPC server: TLS, timeouts, and limits of memory and sizes.
#pragma once

#include <grpcpp/server_builder.h>

#include <chrono>
#include <string>

#include "rpc_port/port_limits.h"

namespace thunderhead::rpc_port {

// PEM files, which are read again when they change. If both names are empty, TLS is off.
struct TlsFiles {
  std::string certificate;  // certificate chain, the server's own certificate first
  std::string key;
  unsigned look_every_s = 5;
};

// The time for a peer to acknowledge a keepalive ping or sent data. Then its connection is closed.
inline constexpr std::chrono::milliseconds kKeepaliveTimeout{10'000};

// Sets the limits and timeouts of the server. Its responses have at most `max_response_bytes`.
void SetLimits(grpc::ServerBuilder& builder, const PortLimits& limits, int max_response_bytes);

}  // namespace thunderhead::rpc_port
