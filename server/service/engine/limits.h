// Limits of the service that an operator can set. A request beyond a limit is refused with
// RESOURCE_EXHAUSTED and the time after which to retry, except that a late Join is refused with
// DEADLINE_EXCEEDED. The ranges of numbers in messages are not here but in the schema
// (limits.proto).
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "absl/status/status.h"
#include "rpc_port/port_limits.h"
#include "thunderhead/v1/scene.pb.h"

namespace thunderhead::service {

struct Limits : rpc_port::PortLimits {
  // Maximum number of viewers that use Interact, and separately of viewers that use WatchFrames.
  // Presenters are admitted beyond it.
  std::size_t max_viewers_per_session = 256;
  // Maximum number of pixels (width times height), and of samples (pixels times the technique's
  // slices). The defaults are the maxima that CheckScene and the schema allow in any case.
  std::uint64_t max_pixels = std::uint64_t{1} << 25;
  std::uint64_t max_samples = std::uint64_t{1} << 37;
  // Maximum time to make one picture outside sessions, from reading its fields on. Time spent
  // queued does not count.
  std::chrono::milliseconds max_render_time = std::chrono::minutes(30);
  // Timeout for a client of Interact to send Join, measured by PortLimits::time.
  std::chrono::milliseconds join_timeout = std::chrono::seconds(10);
};

// Returns RESOURCE_EXHAUSTED for a picture with more pixels or samples than the limits allow. The
// defaults of `scene` must have been filled in.
absl::Status CheckSize(const Limits& limits, const v1::Scene& scene);

// Returns RESOURCE_EXHAUSTED for a session that has its maximum number of viewers.
absl::Status TooManyViewers(std::size_t maximum);

// Returns RESOURCE_EXHAUSTED for a picture that exceeded its time limit.
absl::Status RenderedTooLong(std::chrono::milliseconds limit);

}  // namespace thunderhead::service
