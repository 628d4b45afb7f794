// The sizes in which a picture is refined by the Monte Carlo reference, and when the picture is
// shown. The first size is small, so that something is visible within a fraction of a second. Each
// further size has twice the width and height, up to the full size. Plain values; the time is an
// argument.
#pragma once

#include "drawing/frame_source.h"
#include "glm/vec2.hpp"

namespace thunderhead::drawing {

class ReferenceSchedule {
 public:
  explicit ReferenceSchedule(const glm::ivec2& full_size_px);

  // Returns the size of the picture to refine now.
  glm::ivec2 SizePx() const;
  bool IsFull() const { return halvings_ == 0; }
  // Returns the number of samples per pixel up to which the picture should be refined next.
  int UntilSamples() const;

  // Returns true if the picture should be shown now, and records that it is shown. `shown_ago_s` is
  // the time since a picture was last shown, or since the beginning.
  bool ShowNow(const delivery::Refinement& refinement, double shown_ago_s);

  // Returns true if the picture has enough samples, so that the next larger size can begin. SizePx
  // then returns the new size.
  bool GrowAt(const delivery::Refinement& refinement);

  // Returns true if more samples would make no visible difference.
  bool Finished(const delivery::Refinement& refinement) const;

 private:
  glm::ivec2 full_size_px_;
  int halvings_ = 0;
  bool any_shown_ = false;
  int shown_samples_ = 0;  // samples of the last shown picture of this size
};

}  // namespace thunderhead::drawing
