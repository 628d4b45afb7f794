// How many small frames may be on their way to one viewer, by how long they take: more on a far
// link, where two would leave it idle, and two on one that is full, where more would only wait. A
// plain value that is told the time.
#pragma once

#include <chrono>
#include <cstddef>

namespace thunderhead::delivery {

class FlightWindow {
 public:
  static constexpr std::size_t kLeast = 2;
  static constexpr std::size_t kMax = 8;

  std::size_t size() const { return size_; }

  // A frame was acknowledged `round_trip` after it was sent; `was_full` when no further one could
  // be sent meanwhile.
  void Acknowledged(std::chrono::nanoseconds round_trip, bool was_full);

 private:
  std::size_t size_ = kLeast;
  double shortest_ms_ = 0.0;  // of an empty link; 0: not known
};

}  // namespace thunderhead::delivery
