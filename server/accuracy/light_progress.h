// The progress of tracing a scene's light, and a claim on the light. Plain values.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>

namespace thunderhead::accuracy {

// Minimum number of paths for a correction; with fewer it is mostly noise. With only the first
// picture's paths the error grew by 21 to 48 % on two storms of three. With this many it was 14 to
// 47 % less on all of them (docs/decisions/0012).
inline constexpr std::int64_t kMinCorrectingPaths = 25'000;

// While a claim exists, the light traced for its scene is not evicted for another scene.
using LightClaim = std::shared_ptr<const void>;

struct LightProgress {
  std::int64_t paths = 0;
  std::int64_t steps = 0;  // 0 if there is nothing to trace

  // Returns true if a correction by these paths is worth applying.
  bool Corrects() const { return paths >= kMinCorrectingPaths; }

  // Returns the completed share of tracing `wanted` paths, 0 to 1. The number of steps that should
  // have sufficed counts as well. Few rays hit a small or thin storm, and waiting for more would
  // take too long.
  double ShareOf(std::int64_t wanted) const {
    constexpr std::int64_t kMinPathsPerStep = 300;
    const std::int64_t done = std::max(paths, kMinPathsPerStep * steps);
    return done >= wanted ? 1.0 : static_cast<double>(done) / static_cast<double>(wanted);
  }
  bool HasTraced(std::int64_t wanted) const { return ShareOf(wanted) >= 1.0; }
};

}  // namespace thunderhead::accuracy
