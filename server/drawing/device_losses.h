// When to make the device ready again after it was lost, and when to give up. A plain value.
#pragma once

#include <chrono>
#include <deque>
#include <optional>

namespace thunderhead::drawing {

struct LossLimits {
  // The first loss is mended at once, the next after this, and each further one within `window`
  // after twice as long.
  std::chrono::milliseconds first_pause{1000};
  int max_losses = 6;
  std::chrono::milliseconds window = std::chrono::minutes(10);
};

class DeviceLosses {
 public:
  using Time = std::chrono::steady_clock::time_point;

  explicit DeviceLosses(const LossLimits& limits) : limits_(limits) {}

  // The device was lost, or could not be made ready. When to try it; none to give up: a device that
  // is lost again and again needs somebody else's help.
  std::optional<Time> Lost(Time now);

 private:
  const LossLimits limits_;
  std::deque<Time> losses_;  // within the window
};

}  // namespace thunderhead::drawing
