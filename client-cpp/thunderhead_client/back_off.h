// Exponential back-off with full jitter: a delay is drawn at random below a bound that doubles, so
// that a whole class does not come back at once.
#pragma once

#include <chrono>
#include <random>

namespace thunderhead::client {

class BackOff {
 public:
  static constexpr std::chrono::milliseconds kFirstBound{1000};
  static constexpr std::chrono::milliseconds kLongestBound{8000};

  explicit BackOff(unsigned seed = std::random_device{}()) : random_(seed) {}

  // The delay before the next attempt; not below `least`, which the server asked for.
  std::chrono::milliseconds Next(std::chrono::milliseconds least = {});
  // An attempt succeeded.
  void Reset() { attempts_ = 0; }
  int attempts() const { return attempts_; }

 private:
  std::mt19937 random_;
  int attempts_ = 0;
};

}  // namespace thunderhead::client
