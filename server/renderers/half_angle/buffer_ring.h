// A ring of buffers with dirty rectangles: each holds every n-th state of something. Pure
// bookkeeping: no GL.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "renderers/cover.h"

namespace thunderhead::renderers {

// Initially all buffers hold state 0; each state follows from the one before.
class BufferRing {
 public:
  explicit BufferRing(std::size_t buffers) : missing_(buffers) {}

  // The buffer that holds a state.
  std::size_t Of(std::size_t state) const { return state % missing_.size(); }

  // The rectangle to write in the buffer of `state`: `changed`, where the state may differ from the
  // one before, and all changes since that buffer was last written. Call it for each state from 1
  // on.
  PixelRect Write(std::size_t state, const PixelRect& changed) {
    for (PixelRect& rect : missing_) rect = Around(rect, changed);
    return std::exchange(missing_[Of(state)], PixelRect());
  }

 private:
  std::vector<PixelRect> missing_;
};

}  // namespace thunderhead::renderers
