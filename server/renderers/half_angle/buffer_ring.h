// A ring of buffers with dirty rectangles: each holds every n-th state of something. Pure
// bookkeeping: no GL.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "renderers/cover.h"

namespace thunderhead::renderers {

// State 0 is in all buffers at first, and each state follows from the one before.
class Turns {
 public:
  explicit Turns(std::size_t buffers) : missing_(buffers) {}

  // Which buffer holds a state.
  std::size_t Of(std::size_t state) const { return state % missing_.size(); }

  // Where the buffer of `state` is to be written: in `changed`, where that state may differ from
  // the one before, and wherever it has missed changes since its last turn. To be called for each
  // state from 1 on.
  PixelRect Write(std::size_t state, const PixelRect& changed) {
    for (PixelRect& rect : missing_) rect = Around(rect, changed);
    return std::exchange(missing_[Of(state)], PixelRect());
  }

 private:
  std::vector<PixelRect> missing_;
};

}  // namespace thunderhead::renderers
