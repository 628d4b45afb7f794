// Plays a storm's times at a chosen rate, and waits for the picture of one time before it goes on
// to the next. A plain value.
#pragma once

#include <array>
#include <chrono>
#include <optional>

namespace thunderhead::client {

class Playback {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  static constexpr std::array<float, 6> kRates{0.5F, 1.0F, 2.0F, 4.0F, 8.0F, 15.0F};

  float times_per_second = 2.0F;
  bool loops = true;  // false: ends at the last time

  bool playing() const { return playing_; }
  void Pause() { playing_ = false; }
  // Begins or ends playing. The time to show at once, if any.
  std::optional<int> Toggle(int index, int count);
  // The time `by` steps on, around the ends.
  static int Step(int index, int by, int count);
  // The next time to show, if it is due; `shown` is true once the picture of `index` is on the
  // screen.
  std::optional<int> Advance(int index, int count, bool shown, TimePoint now);

 private:
  bool playing_ = false;
  TimePoint last_step_{};
};

}  // namespace thunderhead::client
