// Exponential back-off with full jitter. Each delay is random below a bound, and the bound doubles
// after each attempt. Many clients that lose their server together therefore do not reconnect all
// at once.
#pragma once

#include <chrono>
#include <random>

namespace thunderhead::client {

class BackOff {
 public:
  static constexpr std::chrono::milliseconds kFirstBound{1000};
  static constexpr std::chrono::milliseconds kLongestBound{8000};

  explicit BackOff(unsigned seed = std::random_device{}()) : random_(seed) {}

  // Returns the delay before the next attempt. The delay is at least `least`, the minimum delay
  // that the server asked for.
  std::chrono::milliseconds Next(std::chrono::milliseconds least = {});
  // Starts again with short delays after an attempt that succeeded.
  void Reset() { attempts_ = 0; }
  int attempts() const { return attempts_; }

 private:
  std::mt19937 random_;
  int attempts_ = 0;
};

}  // namespace thunderhead::client
