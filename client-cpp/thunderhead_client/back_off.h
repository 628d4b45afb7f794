// Exponential back-off with full jitter. Each delay is random below a bound, and the bound doubles
// after each attempt. Many clients that lose their server together therefore do not reconnect all
// at once.
#pragma once

#include <chrono>
#include <functional>
#include <utility>

namespace thunderhead::client {

class BackOff {
 public:
  static constexpr std::chrono::milliseconds kFirstBound{1000};
  static constexpr std::chrono::milliseconds kLongestBound{8000};

  // Draws the random numbers from a seed that differs between clients.
  BackOff();
  // `random` returns a number from 0 to 1.
  explicit BackOff(std::function<double()> random) : random_(std::move(random)) {}

  // Returns the delay before the next attempt. The delay is at least `least`, the minimum delay
  // that the server asked for.
  std::chrono::milliseconds Next(std::chrono::milliseconds least = {});
  // Starts again with short delays after an attempt that succeeded.
  void Reset() { attempts_ = 0; }
  int attempts() const { return attempts_; }

 private:
  std::function<double()> random_;
  int attempts_ = 0;
};

}  // namespace thunderhead::client
