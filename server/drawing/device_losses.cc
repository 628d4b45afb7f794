#include "drawing/device_losses.h"

namespace thunderhead::drawing {

std::optional<DeviceLosses::Time> DeviceLosses::Lost(Time now) {
  while (!losses_.empty() && losses_.front() + limits_.window <= now) losses_.pop_front();
  losses_.push_back(now);
  const auto count = static_cast<int>(losses_.size());
  if (count > limits_.max_losses) return std::nullopt;
  if (count == 1) return now;
  return now + limits_.first_pause * (1 << (count - 2));
}

}  // namespace thunderhead::drawing
