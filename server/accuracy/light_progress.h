// Progress of tracing a scene's light, and a claim on it. Plain values.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>

namespace thunderhead::accuracy {

// With fewer paths a correction is mostly noise: by the first picture's paths alone the error grew
// by 21 to 48 % on two storms of three; with this many it was 14 to 47 % less on all
// (docs/decisions/0012).
inline constexpr std::int64_t kMinCorrectingPaths = 25'000;

// While one exists, the light traced for its scene is not given up for another's.
using LightClaim = std::shared_ptr<const void>;

struct LightProgress {
  std::int64_t paths = 0;
  std::int64_t steps = 0;  // 0 if there is nothing to trace

  // True if a correction by these paths is worth applying.
  bool Corrects() const { return paths >= kMinCorrectingPaths; }

  // How much of the tracing of `wanted` paths is done, 0 to 1. As many steps as should have
  // sufficed count as well: few rays meet a small or thin storm, and waiting for more would take
  // too long.
  double ShareOf(std::int64_t wanted) const {
    constexpr std::int64_t kMinPathsPerStep = 300;
    const std::int64_t done = std::max(paths, kMinPathsPerStep * steps);
    return done >= wanted ? 1.0 : static_cast<double>(done) / static_cast<double>(wanted);
  }
  bool HasTraced(std::int64_t wanted) const { return ShareOf(wanted) >= 1.0; }
};

}  // namespace thunderhead::accuracy
