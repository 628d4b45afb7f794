// How far moving pictures are to be reduced for one viewer's link, from when frames were sent and
// acknowledged. A plain value that is told the time.
//
// A slow link and a far one look alike: frames take long. So the next step is tried, and kept if it
// helps.
#pragma once

#include <chrono>
#include <optional>

namespace thunderhead::delivery {

// Pictures are sent in this many sizes: tier 0 as the scene asks, each further one with half the
// width and height.
inline constexpr int kTiers = 3;

class LinkEstimate {
 public:
  using Time = std::chrono::steady_clock::time_point;

  // A link that needs longer than this for a frame is tried with the next step, so that at least 10
  // a second arrive.
  static constexpr std::chrono::milliseconds kLongest{100};
  // The step before is tried after so long; each trial that fails doubles the wait for the next.
  static constexpr std::chrono::seconds kShortestWait{4};
  static constexpr std::chrono::seconds kLongestWait{64};

  // `steps` in all, each with fewer bytes than the one before: the tiers, unless the viewer can
  // be reduced otherwise as well.
  explicit LinkEstimate(int steps = kTiers) : steps_(steps) {}

  // No step below this one.
  void SetLeast(int step, Time now);

  // A frame that was sent at `sent_at` was acknowledged.
  void Acknowledged(Time now, Time sent_at);

  // Of moving pictures; stills are worth waiting for.
  int step() const { return step_; }

 private:
  // A step on trial, and the one before it.
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
  int samples_ = 0;        // of this step
  double frame_ms_ = 0.0;  // smoothed: from one frame's arrival to the next's
  std::optional<Time> last_acknowledged_;
  Time changed_at_;
  std::optional<Trial> trial_;
  std::chrono::seconds wait_to_grow_ = kShortestWait;
  std::optional<Time> shrink_again_at_;
};

// Of a picture in pixels, and of the one at rest that it stands for, which may be wider.
struct PictureWidth {
  int px = 0;
  int full_px = 0;
};

// The tier of a picture for a window: the smallest that fills it; 0 for a window of unknown width,
// 0. One that moves has the tier that it will have at rest, unless it would have less than half of
// the window's pixels.
int TierForWindow(const PictureWidth& picture, int window_px);

}  // namespace thunderhead::delivery
