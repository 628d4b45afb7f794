// A rectangle of pixels and its operations.
#pragma once

#include "glm/common.hpp"
#include "glm/vec2.hpp"

namespace thunderhead::gl {

// A rectangle of pixels. Rows are counted from the bottom. `high` is just outside the rectangle.
struct PixelRect {
  glm::ivec2 low{0};
  glm::ivec2 high{0};

  bool Empty() const { return low.x >= high.x || low.y >= high.y; }
  glm::ivec2 Size() const { return high - low; }
  bool operator==(const PixelRect&) const = default;
};

// Returns the bounding rectangle of `a` and `b`. An empty rectangle is ignored.
inline PixelRect Around(const PixelRect& a, const PixelRect& b) {
  if (a.Empty()) return b;
  if (b.Empty()) return a;
  return {glm::min(a.low, b.low), glm::max(a.high, b.high)};
}

}  // namespace thunderhead::gl
