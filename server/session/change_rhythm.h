// How soon after a change of a scene the next one of the same gesture is to be expected. Changes
// that are made thirty times a second come at larger and uneven distances over a far or full link:
// a scene that has just changed so rests only after a longer pause. A plain value that is told the
// time.
#pragma once

#include <chrono>
#include <optional>

namespace thunderhead::session {

class ChangeRhythm {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Duration = std::chrono::steady_clock::duration;

  // A change that comes later begins another gesture.
  static constexpr std::chrono::milliseconds kLongestPause{700};

  // The scene has changed. Returns the usual pause before the next change: the longest of late,
  // forgotten slowly; 0 after the first change of a gesture.
  Duration Changed(Time now);

 private:
  std::optional<Time> last_;
  Duration pause_{};
};

}  // namespace thunderhead::session
