// Predicts the time from one change of a scene to the next change of the same gesture, such as a
// drag of the camera. Clients send changes at short intervals, for example thirty times a second.
// Over a slow or distant link they arrive at larger and uneven intervals. A scene that changes in a
// gesture counts as at rest only after a longer pause. A plain value; the time is an argument.
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

  // Records a change of the scene. Returns the pause to expect before the next change: the longest
  // recent pause between changes, which decays slowly. Returns 0 after the first change of a
  // gesture.
  Duration Changed(Time now);

 private:
  std::optional<Time> last_;
  Duration pause_{};
};

}  // namespace thunderhead::session
