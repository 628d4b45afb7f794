// In which sizes a picture is refined towards the truth, and when it is shown: small at first, so
// that something is seen within a fraction of a second, then twice as large each time, and at the
// full size for as long as it is looked at. Plain values; the time is given.
#pragma once

#include "glm/vec2.hpp"
#include "session/frame_source.h"

namespace thunderhead::session {

class TruthSchedule {
 public:
  explicit TruthSchedule(const glm::ivec2& full_size_px);

  // Of the picture to be refined now.
  glm::ivec2 SizePx() const;
  bool IsFull() const { return halvings_ == 0; }
  // How many samples to ask for, of each pixel.
  int UntilSamples() const;

  // The picture has come that far; `shown_ago_s` is the time since one was shown, or since the
  // beginning. True if it is to be shown now, and is then taken as shown.
  bool ShowNow(const Refinement& refinement, double shown_ago_s);

  // True if the picture has come far enough to begin the next larger one, which is then the one to
  // refine.
  bool GrowAt(const Refinement& refinement);

  // Nobody could see a difference any more.
  bool Finished(const Refinement& refinement) const;

 private:
  glm::ivec2 full_size_px_;
  int halvings_ = 0;
  bool any_shown_ = false;
  int shown_samples_ = 0;  // of the picture of this size
};

}  // namespace thunderhead::session
