// Decides when to reopen the rendering device after it was lost, and when to stop trying. A plain
// value.
#pragma once

#include <chrono>
#include <deque>
#include <optional>

namespace thunderhead::drawing {

struct LossLimits {
  // After the first loss within `window`, the device is reopened immediately. After the second loss
  // it is reopened after `first_pause`. Each further loss doubles the pause.
  std::chrono::milliseconds first_pause{1000};
  int max_losses = 6;
  std::chrono::milliseconds window = std::chrono::minutes(10);
};

class DeviceLosses {
 public:
  using Time = std::chrono::steady_clock::time_point;

  explicit DeviceLosses(const LossLimits& limits) : limits_(limits) {}

  // Records that the device was lost or could not be opened. Returns when to open it, or none to
  // stop trying: a device that is lost repeatedly needs an operator.
  std::optional<Time> Lost(Time now);

 private:
  const LossLimits limits_;
  std::deque<Time> losses_;  // losses within the window
};

}  // namespace thunderhead::drawing
