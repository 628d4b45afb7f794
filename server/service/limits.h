// Limits of the service that an operator can set. A request beyond a limit is refused with
// RESOURCE_EXHAUSTED and the time after which to retry. The ranges of numbers in messages are not
// here but in the schema (limits.proto).
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "absl/status/status.h"
#include "base/time_source.h"
#include "thunderhead/v1/scene.pb.h"

namespace thunderhead::service {

struct Limits {
  // Maximum number of connections to gRPC's port, in total and from one address. Trusted proxies
  // have no limit per address.
  std::size_t max_connections = 768;
  std::size_t max_connections_per_address = 512;
  // Maximum number of TLS handshakes per second from one address, with bursts of twice as many; 0
  // means no limit.
  double max_handshakes_per_address = 256.0;
  // Maximum number of viewers that use Interact, and separately of viewers that use WatchFrames.
  // Presenters are admitted beyond it.
  std::size_t max_viewers_per_session = 256;
  // Maximum number of pixels (width times height), and of samples (pixels times the technique's
  // slices). The defaults are the maxima that the schema allows.
  std::uint64_t max_pixels = std::uint64_t{1} << 25;
  std::uint64_t max_samples = std::uint64_t{1} << 37;
  // Maximum time to make one picture outside sessions, from reading its fields on. Time spent
  // queued does not count.
  std::chrono::milliseconds max_render_time = std::chrono::minutes(30);
  // A client must receive a finished picture, or each part of it, within delivery_time plus the
  // time that its bytes take at min_bytes_per_second. After that the call is cancelled.
  std::chrono::milliseconds delivery_time = std::chrono::minutes(2);
  double min_bytes_per_second = 8192.0;
  // Timeout for a client of Interact to send Join.
  std::chrono::milliseconds join_timeout = std::chrono::seconds(10);
  // Timeout of a connection to gRPC's port that has no admitted call, even if its client has
  // announced calls. The connection is then closed. Slightly earlier, gRPC itself gracefully closes
  // a connection without any call.
  std::chrono::milliseconds unused_connection = std::chrono::seconds(75);
  // Maximum size of a request; a scene takes at most a few kilobytes.
  std::size_t max_request_bytes = 1u << 20;
  // Maximum size of gRPC's buffers for all connections together. When it is nearly reached, calls
  // are refused.
  std::size_t grpc_memory_bytes = std::size_t{1} << 30;
  // Maximum number of concurrent calls of a connection. Further calls wait in the client.
  int max_streams_per_connection = 1024;
  // The time source for delivery_time, join_timeout, unused_connection and
  // max_handshakes_per_address. It must outlive the server.
  const base::TimeSource* time = &base::SteadyTime();
};

// Returns the time that a client has to receive `bytes` bytes of a picture.
std::chrono::milliseconds DeliveryTime(const Limits& limits, std::size_t bytes);

// Returns RESOURCE_EXHAUSTED for a picture with more pixels or samples than the limits allow. The
// defaults of `scene` must have been filled in.
absl::Status CheckSize(const Limits& limits, const v1::Scene& scene);

// Returns RESOURCE_EXHAUSTED for a session that has its maximum number of viewers.
absl::Status TooManyViewers(std::size_t maximum);

// Returns RESOURCE_EXHAUSTED for a picture that exceeded its time limit.
absl::Status RenderedTooLong(std::chrono::milliseconds limit);

}  // namespace thunderhead::service
