#include "delivery/flight_window.h"

#include <algorithm>

namespace thunderhead::delivery {
namespace {

// Frames that take little longer than the fastest one do not queue behind one another.
constexpr double kFree = 1.3;
constexpr double kFree_ms = 15.0;
// Frames that take this much longer than the fastest one queue.
constexpr double kQueued = 2.0;
constexpr double kQueued_ms = 40.0;
// The shortest round trip is forgotten slowly because the path may become longer.
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
