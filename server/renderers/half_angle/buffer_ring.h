// Bookkeeping for a ring of n buffers, of which each holds every nth state of an image. It records
// which rectangle of each buffer is outdated. The class does not use GL.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "renderers/cover.h"

namespace thunderhead::renderers {

// Initially all buffers hold state 0. Each state is computed from the state before it.
class BufferRing {
 public:
  explicit BufferRing(std::size_t buffers) : missing_(buffers) {}

  // Returns the index of the buffer that holds a state.
  std::size_t Of(std::size_t state) const { return state % missing_.size(); }

  // Returns the rectangle that must be written in the buffer of `state`. It contains `changed`, in
  // which the state may differ from the state before. It also contains all changes since that
  // buffer was last written. Call the function for each state from 1 on.
  PixelRect Write(std::size_t state, const PixelRect& changed) {
    for (PixelRect& rect : missing_) rect = Around(rect, changed);
    return std::exchange(missing_[Of(state)], PixelRect());
  }

 private:
  std::vector<PixelRect> missing_;
};

}  // namespace thunderhead::renderers
