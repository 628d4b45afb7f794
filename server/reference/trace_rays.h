// Mean radiance along any rays, not only a picture's.
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

// A PathOptions::similar_after that is worth its bias: an error takes a third to a tenth of the
// time, storms are off by half a percent and wide layers by 1.7 %
// (docs/decisions/0056-similar-medium.md).
inline constexpr int kSimilarAfter = 4;

// Why tracing must end; OK while it may go on. Asked every few milliseconds, by any thread.
using IsWanted = std::function<absl::Status()>;

struct TraceRaysOptions {
  std::uint64_t seed = 0;
  int paths_per_ray = 1;
  int threads = 0;            // 0: as many as the machine has
  int similar_after = 0;      // PathOptions::similar_after
  IsWanted wanted = nullptr;  // null: always
};

// Radiance that arrives along each of `rays`: the mean of `paths_per_ray` estimates. The same, bit
// for bit, for any number of threads. Fails only as `wanted` does.
absl::StatusOr<std::vector<glm::dvec3>> TraceRays(const Medium& medium,
                                                  const Surroundings& surroundings,
                                                  const std::vector<Ray>& rays,
                                                  const TraceRaysOptions& options);

// TraceRays in a medium, by the processors or whoever computes the same (device_paths/).
using RayTracer = std::function<absl::StatusOr<std::vector<glm::dvec3>>(
    const Surroundings&, const std::vector<Ray>&, const TraceRaysOptions&)>;

RayTracer TracerOnProcessors(std::shared_ptr<const Medium> medium);

using MakesTracer =
    std::function<absl::StatusOr<RayTracer>(const std::shared_ptr<const Medium>& medium)>;

}  // namespace thunderhead::reference
