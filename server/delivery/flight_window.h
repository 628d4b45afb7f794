// The maximum number of unacknowledged video frames of one viewer, from the round-trip times. It
// grows on a link with a long delay, which two frames would leave idle. It shrinks to two on a
// saturated link, where more frames would only queue. A plain value; the time is an argument.
#pragma once

#include <chrono>
#include <cstddef>

namespace thunderhead::delivery {

class FlightWindow {
 public:
  static constexpr std::size_t kLeast = 2;
  static constexpr std::size_t kMax = 8;

  std::size_t size() const { return size_; }

  // Records that a frame was acknowledged `round_trip` after it was sent. `was_full` says that the
  // window was full, so that no further frame could be sent meanwhile.
  void Acknowledged(std::chrono::nanoseconds round_trip, bool was_full);

 private:
  std::size_t size_ = kLeast;
  double shortest_ms_ = 0.0;  // shortest round trip, of an idle link; 0: not known
};

}  // namespace thunderhead::delivery
