// Estimates the mean radiance along any rays, not only those of a picture.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "glm/vec3.hpp"
#include "reference/brick_walk.h"
#include "reference/medium.h"
#include "reference/surroundings.h"

namespace thunderhead::reference {

// A value of PathOptions::similar_after whose bias is acceptable. It reduces the time for a given
// error to between a third and a tenth. The resulting bias is half a percent for storms and 1.7 %
// for wide layers (docs/decisions/0056-similar-medium.md).
inline constexpr int kSimilarAfter = 4;

// Returns an error that says why tracing must end, or OK if it may continue. It is called every few
// milliseconds, from any thread.
using IsWanted = std::function<absl::Status()>;

struct TraceRaysOptions {
  std::uint64_t seed = 0;
  int paths_per_ray = 1;
  int threads = 0;            // number of threads; 0 means as many as the machine has
  int similar_after = 0;      // PathOptions::similar_after
  IsWanted wanted = nullptr;  // if null, tracing always continues
};

// Returns the radiance that arrives along each of `rays`, which is the mean of `paths_per_ray`
// estimates. The result is bit-identical for any number of threads. The function fails only with an
// error of `options.wanted`.
absl::StatusOr<std::vector<glm::dvec3>> TraceRays(const Medium& medium,
                                                  const Surroundings& surroundings,
                                                  const std::vector<Ray>& rays,
                                                  const TraceRaysOptions& options);

// A function like TraceRays for one medium, on the CPU or on a device (device_paths/). A device
// estimates the same radiance with different random numbers, and it can also fail because it cannot
// draw.
using RayTracer = std::function<absl::StatusOr<std::vector<glm::dvec3>>(
    const Surroundings&, const std::vector<Ray>&, const TraceRaysOptions&)>;

RayTracer TracerOnProcessors(std::shared_ptr<const Medium> medium);

using MakesTracer =
    std::function<absl::StatusOr<RayTracer>(const std::shared_ptr<const Medium>& medium)>;

}  // namespace thunderhead::reference
