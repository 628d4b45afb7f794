// Limits of gRPC's port and of its calls that an operator can set. A connection or call beyond a
// limit is refused or ended.
#pragma once

#include <chrono>
#include <cstddef>

#include "base/time_source.h"

namespace thunderhead::rpc_port {

struct PortLimits {
  // Maximum number of connections to gRPC's port, in total and from one address. Trusted proxies
  // have no limit per address.
  std::size_t max_connections = 768;
  std::size_t max_connections_per_address = 512;
  // Maximum number of TLS handshakes per second from one address, with bursts of twice as many; 0
  // means no limit.
  double max_handshakes_per_address = 256.0;
  // Maximum number of calls per second that one address begins on gRPC's port, with bursts of twice
  // as many; 0 means no limit. Beyond it all connections of the address are closed.
  double max_calls_per_address = 2000.0;
  // A client must receive a finished picture, or each part of it, within delivery_time plus the
  // time that its bytes take at min_bytes_per_second, but at most within max_delivery_time. After
  // that the call is cancelled.
  std::chrono::milliseconds delivery_time = std::chrono::minutes(2);
  double min_bytes_per_second = 8192.0;
  std::chrono::milliseconds max_delivery_time = std::chrono::hours(1);
  // Timeout of a connection to gRPC's port that has no admitted call, even if its client has begun
  // calls that were not admitted. The connection is then closed. Slightly earlier, gRPC itself
  // gracefully closes a connection without any call.
  std::chrono::milliseconds unused_connection = std::chrono::seconds(75);
  // Maximum size of a request; a scene takes at most a few kilobytes.
  std::size_t max_request_bytes = 1u << 20;
  // Maximum size of gRPC's buffers for all connections together. When it is nearly reached, calls
  // are refused.
  std::size_t grpc_memory_bytes = std::size_t{1} << 30;
  // Maximum number of concurrent calls of a connection. Further calls wait in the client.
  int max_streams_per_connection = 1024;
  // The time source for all these times and rates. It must outlive the server.
  const base::TimeSource* time = &base::SteadyTime();
};

// Returns the time that a client has to receive a message of `bytes` bytes.
std::chrono::milliseconds DeliveryTime(const PortLimits& limits, std::size_t bytes);

}  // namespace thunderhead::rpc_port
