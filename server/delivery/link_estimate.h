// Chooses by how much to reduce moving pictures for one viewer's link, from the times at which
// frames were sent and acknowledged. A plain value; the time is an argument.
//
// A link with low bandwidth and one with a long delay look alike because frames take long on both.
// So the estimate tries the next step and keeps it if it helps.
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

  // If frames take longer than this on a link, the next step is tried, so that at least 10 frames a
  // second arrive.
  static constexpr std::chrono::milliseconds kLongest{100};
  // Time until the previous step is tried again. Each failed trial doubles it.
  static constexpr std::chrono::seconds kShortestWait{4};
  static constexpr std::chrono::seconds kLongestWait{64};

  // `steps` is the number of steps; each has fewer bytes than the one before. By default the steps
  // are the tiers.
  explicit LinkEstimate(int steps = kTiers) : steps_(steps) {}

  // Sets the lowest step that may be used.
  void SetLeast(int step, Time now);

  // Records that a frame sent at `sent_at` was acknowledged.
  void Acknowledged(Time now, Time sent_at);

  // Returns the step for moving pictures. Stills are sent in full because they are worth waiting
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
  int samples_ = 0;        // samples of this step
  double frame_ms_ = 0.0;  // smoothed time from one frame's arrival to the next
  std::optional<Time> last_acknowledged_;
  Time changed_at_;
  std::optional<Trial> trial_;
  std::chrono::seconds wait_to_grow_ = kShortestWait;
  std::optional<Time> shrink_again_at_;
};

// The width of a picture, and of the picture at rest that it stands for, which may be wider.
struct PictureWidth {
  int px = 0;
  int full_px = 0;
};

// Returns the tier of a picture for a window: the smallest one that fills it. It is 0 if the
// window's width is unknown (0). A moving picture has the tier that it will have at rest, unless it
// would then have less than half of the window's pixels.
int TierForWindow(const PictureWidth& picture, int window_px);

}  // namespace thunderhead::delivery
