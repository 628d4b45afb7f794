#include "delivery/flight_window.h"

#include <algorithm>

namespace thunderhead::delivery {
namespace {

// A round trip of at most kFree times the shortest one plus kFree_ms means that frames do not queue
// on the link.
constexpr double kFree = 1.3;
constexpr double kFree_ms = 15.0;
// A round trip of more than kQueued times the shortest one plus kQueued_ms means that frames queue
// on the link.
constexpr double kQueued = 2.0;
constexpr double kQueued_ms = 40.0;
// Factor by which the shortest round trip grows with each acknowledgement, because the network path
// may become longer.
constexpr double kForget = 1.005;

}  // namespace

void FlightWindow::Acknowledged(std::chrono::nanoseconds round_trip, bool was_full) {
  const double ms = std::chrono::duration<double, std::milli>(round_trip).count();
  shortest_ms_ = shortest_ms_ <= 0.0 ? ms : std::min(shortest_ms_ * kForget, ms);
  if (ms > kQueued * shortest_ms_ + kQueued_ms) {
    size_ = std::max(size_ - 1, kLeast);
  } else if (was_full && ms < kFree * shortest_ms_ + kFree_ms) {
    size_ = std::min(size_ + 1, kMax);
  }
}

}  // namespace thunderhead::delivery
