// The progress of path tracing a scene's light, and a claim on the path-traced correction.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>

namespace thunderhead::accuracy {

// The minimum number of paths for a correction; a correction from fewer paths is mostly noise. With
// the paths of only one probe, the picture's error was 21 to 48 % larger than without correction
// for two of three storms. With this number of paths, the error was 14 to 46 % smaller for all
// three (docs/lab/0012-traced-light.md).
inline constexpr std::int64_t kMinCorrectingPaths = 25'000;

// A claim on the light traced for a scene. While the claim exists, the light is not evicted in
// favour of another scene.
using LightClaim = std::shared_ptr<const void>;

struct LightProgress {
  std::int64_t paths = 0;
  std::int64_t steps = 0;  // number of steps; 0 if there is nothing to trace

  // Returns true if a correction by these paths is worth applying.
  bool Corrects() const { return paths >= kMinCorrectingPaths; }

  // Returns the completed share of tracing `wanted` paths, 0 to 1. Each step counts as at least
  // kMinPathsPerStep paths. Otherwise tracing a small or thin storm, which few rays hit, would take
  // too long.
  double ShareOf(std::int64_t wanted) const {
    constexpr std::int64_t kMinPathsPerStep = 300;
    const std::int64_t done = std::max(paths, kMinPathsPerStep * steps);
    return done >= wanted ? 1.0 : static_cast<double>(done) / static_cast<double>(wanted);
  }
  bool HasTraced(std::int64_t wanted) const { return ShareOf(wanted) >= 1.0; }
};

}  // namespace thunderhead::accuracy
