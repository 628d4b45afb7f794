// Predicts how soon after a change of a scene the next change of the same gesture comes. Clients
// send changes thirty times a second, but they arrive at larger and uneven intervals over a slow or
// distant link. A scene changed in such a gesture is at rest only after a longer pause. A plain
// value; the time is an argument.
#pragma once

#include <chrono>
#include <optional>

namespace thunderhead::session {

class ChangeRhythm {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Duration = std::chrono::steady_clock::duration;

  // A change after a longer pause begins another gesture.
  static constexpr std::chrono::milliseconds kLongestPause{700};

  // Records a change of the scene. Returns the usual pause before the next change: the longest
  // recent pause, which is forgotten slowly. It is 0 after the first change of a gesture.
  Duration Changed(Time now);

 private:
  std::optional<Time> last_;
  Duration pause_{};
};

}  // namespace thunderhead::session
