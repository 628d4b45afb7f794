// Chooses how much smaller the moving pictures for one viewer must be because of its link. It uses
// the times at which frames were sent and acknowledged. A plain value; the time is an argument.
//
// Frames take long both on a link with low bandwidth and on a link with a long delay. To tell the
// two apart, the estimate tries the next smaller step and keeps it only if frames arrive faster
// than before.
#pragma once

#include <chrono>
#include <optional>

namespace thunderhead::delivery {

// Number of picture sizes. Tier 0 has the size that the scene asks for; each further tier has half
// the width and height.
inline constexpr int kTiers = 3;

class LinkEstimate {
 public:
  using Time = std::chrono::steady_clock::time_point;

  // If frames take longer than this to arrive, the next step is tried. The aim is at least 10
  // frames a second.
  static constexpr std::chrono::milliseconds kLongest{100};
  // Time until the larger pictures of the previous step are tried again. Each failed trial doubles
  // the time.
  static constexpr std::chrono::seconds kShortestWait{4};
  static constexpr std::chrono::seconds kLongestWait{64};

  // `steps` is the number of steps. Each step has fewer bytes per picture than the step before. By
  // default, the steps are the tiers.
  explicit LinkEstimate(int steps = kTiers) : steps_(steps) {}

  // Sets the first step (the largest pictures) that may be used.
  void SetLeast(int step, Time now);

  // Records that a frame sent at `sent_at` was acknowledged.
  void Acknowledged(Time now, Time sent_at);

  // Returns the step for moving pictures. Resting frames ignore it, because they are worth waiting
  // for.
  int step() const { return step_; }

 private:
  // The state before the step that is on trial.
  struct Trial {
    int step_before = 0;
    double frame_ms_before = 0.0;
  };

  void Judge(Time now);
  void Try(int step, Time now);
  void ChangeTo(int step, Time now);

  int steps_;
  int least_ = 0;
  int step_ = 0;
  int samples_ = 0;        // number of frames acknowledged since this step began
  double frame_ms_ = 0.0;  // smoothed time from one frame's arrival to the next, in ms
  std::optional<Time> last_acknowledged_;
  Time changed_at_;
  std::optional<Trial> trial_;
  std::chrono::seconds wait_to_grow_ = kShortestWait;
  std::optional<Time> shrink_again_at_;
};

// The width of a picture, and the width that the same picture has at rest, which may be larger.
struct PictureWidth {
  int px = 0;
  int full_px = 0;
};

// Returns the tier of a picture for a window: the smallest size that still fills the window.
// Returns 0 if `window_px` is 0 (unknown). A moving picture gets the tier that it will have at
// rest, unless it would then be less than half as wide as the window.
int TierForWindow(const PictureWidth& picture, int window_px);

}  // namespace thunderhead::delivery
