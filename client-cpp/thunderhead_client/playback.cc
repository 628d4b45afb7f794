#include "thunderhead_client/playback.h"

namespace thunderhead::client {

std::optional<int> Playback::Toggle(int index, int count) {
  playing_ = !playing_ && count > 1;
  last_step_.reset();
  if (playing_ && !loops && index >= count - 1) return 0;
  return {};
}

int Playback::Step(int index, int by, int count) {
  return count < 1 ? 0 : (((index + by) % count) + count) % count;
}

std::optional<int> Playback::Advance(int index, int count, bool shown, TimePoint now) {
  const std::chrono::duration<float> interval(1.0F / times_per_second);
  const bool due = !last_step_ || now - *last_step_ >= interval;
  if (!playing_ || !shown || !due) return {};
  if (count < 2 || (!loops && index >= count - 1)) {
    playing_ = false;
    return {};
  }
  last_step_ = now;
  return Step(index, 1, count);
}

}  // namespace thunderhead::client
