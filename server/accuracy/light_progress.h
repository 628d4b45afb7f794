// How far a scene's light has been traced. A plain value.
#pragma once

#include <cstdint>

namespace thunderhead::accuracy {

struct LightProgress {
  std::int64_t paths = 0;
  std::int64_t steps = 0;  // 0 if there is nothing to trace

  // True if as many paths have been traced, or so many steps gone that had hardly any to trace: of
  // a storm so small or thin that few rays meet it, no more are waited for.
  bool HasTraced(std::int64_t wanted) const {
    constexpr std::int64_t kLeastPathsOfStep = 300;
    return paths >= wanted || kLeastPathsOfStep * steps >= wanted;
  }
};

}  // namespace thunderhead::accuracy
