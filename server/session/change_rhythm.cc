#include "session/change_rhythm.h"

#include <algorithm>

namespace thunderhead::session {

ChangeRhythm::Duration ChangeRhythm::Changed(Time now) {
  if (last_.has_value()) {
    const Duration pause = now - *last_;
    pause_ = pause > kLongestPause ? Duration::zero() : std::max(pause, (3 * pause_ + pause) / 4);
  }
  last_ = now;
  return pause_;
}

}  // namespace thunderhead::session
