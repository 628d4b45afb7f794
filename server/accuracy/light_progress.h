// Progress of tracing a scene's light. A plain value.
#pragma once

#include <cstdint>

namespace thunderhead::accuracy {

struct LightProgress {
  std::int64_t paths = 0;
  std::int64_t steps = 0;  // 0 if there is nothing to trace

  // True if `wanted` paths have been traced, or as many steps as should have sufficed: few rays
  // meet a small or thin storm, and waiting for more would take too long.
  bool HasTraced(std::int64_t wanted) const {
    constexpr std::int64_t kMinPathsPerStep = 300;
    return paths >= wanted || kMinPathsPerStep * steps >= wanted;
  }
};

}  // namespace thunderhead::accuracy
