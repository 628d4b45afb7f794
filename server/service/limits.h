// Limits of the service that whoever runs it may set. Each is refused with RESOURCE_EXHAUSTED and a
// time after which to try again. What numbers a message may have at all is in the schema.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "absl/status/status.h"
#include "base/time_source.h"
#include "thunderhead/v1/scene.pb.h"

namespace thunderhead::service {

struct Limits {
  // Of gRPC's port, in all and from one address (trusted proxies have no limit of their own).
  std::size_t max_connections = 768;
  std::size_t max_connections_per_address = 512;
  // TLS handshakes a second from one address; twice as many at once. 0: no limit.
  double max_handshakes_per_address = 256.0;
  // By Interact and by WatchFrames each; presenters are let in beyond it.
  std::size_t max_viewers_per_session = 256;
  // Width times height, and that times the technique's slices. By default what the schema allows.
  std::uint64_t max_pixels = std::uint64_t{1} << 25;
  std::uint64_t max_samples = std::uint64_t{1} << 37;
  // Of one picture outside sessions, from the reading of its fields on: waiting for others does not
  // count.
  std::chrono::milliseconds max_render_time = std::chrono::minutes(30);
  // A picture that is ready, or each part of it, must be taken by its client within this and the
  // time that it takes at this rate; then the call is cancelled.
  std::chrono::milliseconds delivery_time = std::chrono::minutes(2);
  double min_bytes_per_second = 8192.0;
  // Until a client of Interact has joined.
  std::chrono::milliseconds join_timeout = std::chrono::seconds(10);
  // Until a connection of gRPC's port without a call that the door let in is closed, whatever calls
  // it has announced. gRPC itself closes one without any a little earlier, and more kindly.
  std::chrono::milliseconds unused_connection = std::chrono::seconds(75);
  // A scene is at most a few kilobytes.
  std::size_t max_request_bytes = 1u << 20;
  // Of gRPC's buffers, all connections together; near it, calls are refused.
  std::size_t grpc_memory_bytes = std::size_t{1} << 30;
  // Further calls of a connection wait in its client.
  int max_streams_per_connection = 1024;
  // What delivery_time, join_timeout, unused_connection and max_handshakes_per_address are measured
  // by; must outlive the server.
  const base::TimeSource* time = &base::SteadyTime();
};

// How long a client may take for so many bytes of a picture.
std::chrono::milliseconds DeliveryTime(const Limits& limits, std::size_t bytes);

// RESOURCE_EXHAUSTED for a picture that is larger, or has more samples, than the limits allow.
// `scene` has its defaults.
absl::Status CheckSize(const Limits& limits, const v1::Scene& scene);

// RESOURCE_EXHAUSTED for a session with as many viewers as it may have.
absl::Status TooManyViewers(std::size_t maximum);

// RESOURCE_EXHAUSTED for a picture that took longer than it may.
absl::Status RenderedTooLong(std::chrono::milliseconds limit);

}  // namespace thunderhead::service
