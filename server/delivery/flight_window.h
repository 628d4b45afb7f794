// The maximum number of unacknowledged video frames of one viewer, derived from the measured
// round-trip times. It grows on a link with a long delay, because two frames would leave such a
// link idle. It shrinks to two on a saturated link, where more frames would only queue. A plain
// value; the time is an argument.
#pragma once

#include <chrono>
#include <cstddef>

namespace thunderhead::delivery {

class FlightWindow {
 public:
  static constexpr std::size_t kLeast = 2;
  static constexpr std::size_t kMax = 8;

  std::size_t size() const { return size_; }

  // Records that a frame was acknowledged `round_trip` after it was sent. `was_full` is true if the
  // window was full, so that no further frame could be sent in between.
  void Acknowledged(std::chrono::nanoseconds round_trip, bool was_full);

 private:
  std::size_t size_ = kLeast;
  // The shortest round trip so far in milliseconds, as on an idle link; 0 if not known.
  double shortest_ms_ = 0.0;
};

}  // namespace thunderhead::delivery
