// Plays a storm's times at a chosen rate. The playback waits for the picture of one time before it
// continues with the next. This class has no thread and no clock; the caller passes the time.
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
  bool loops = true;  // if false, playback stops at the last time

  bool playing() const { return playing_; }
  void Pause() { playing_ = false; }
  // Starts or stops playback. Returns the index of a time to show at once, if any.
  std::optional<int> Toggle(int index, int count);
  // Returns the index of the time that is `by` steps after `index`. The index wraps around at both
  // ends.
  static int Step(int index, int by, int count);
  // Returns the index of the next time to show, if it is due. `shown` is true once the picture of
  // `index` is on the screen.
  std::optional<int> Advance(int index, int count, bool shown, TimePoint now);

 private:
  bool playing_ = false;
  std::optional<TimePoint> last_step_;
};

}  // namespace thunderhead::client
