// A ring of n buffers with dirty rectangles, in which each buffer holds every nth state. It is pure
// bookkeeping without GL.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "renderers/cover.h"

namespace thunderhead::renderers {

// Initially all buffers hold state 0. Each state follows from the one before.
class BufferRing {
 public:
  explicit BufferRing(std::size_t buffers) : missing_(buffers) {}

  // Returns the buffer that holds a state.
  std::size_t Of(std::size_t state) const { return state % missing_.size(); }

  // Returns the rectangle to write in the buffer of `state`. It contains `changed`, where the state
  // may differ from the one before, and all changes since that buffer was last written. Call it for
  // each state from 1 on.
  PixelRect Write(std::size_t state, const PixelRect& changed) {
    for (PixelRect& rect : missing_) rect = Around(rect, changed);
    return std::exchange(missing_[Of(state)], PixelRect());
  }

 private:
  std::vector<PixelRect> missing_;
};

}  // namespace thunderhead::renderers
