// Delays that simulate a link with a limited rate, on which each message takes time to be
// transmitted.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>

namespace thunderhead::load {

class Pace {
 public:
  using Clock = std::chrono::steady_clock;

  // A rate of 0 means no limit.
  explicit Pace(double kbit_per_s) : kbit_per_s_(kbit_per_s) {}

  bool IsLimited() const { return kbit_per_s_ > 0.0; }
  // Returns how long after `now` a message of `bytes` bytes, which was read at `now`, counts as
  // arrived.
  Clock::duration DelayOf(std::size_t bytes, Clock::time_point now) {
    const std::chrono::duration<double, std::milli> took(8.0 * static_cast<double>(bytes) /
                                                         kbit_per_s_);
    free_at_ = std::max(free_at_, now) + std::chrono::duration_cast<Clock::duration>(took);
    return free_at_ - now;
  }

 private:
  double kbit_per_s_;
  Clock::time_point free_at_;  // time at which the previous message counts as arrived
};

}  // namespace thunderhead::load
