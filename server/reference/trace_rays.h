// Mean radiance along any rays, not only a picture's.
#pragma once

#include <cstdint>
#include <vector>

#include "glm/vec3.hpp"
#include "reference/brick_walk.h"
#include "reference/medium.h"
#include "reference/surroundings.h"

namespace thunderhead::reference {

struct TraceRaysOptions {
  std::uint64_t seed = 0;
  int paths_per_ray = 1;
  int threads = 0;  // 0: as many as the machine has
};

// Radiance that arrives along each of `rays`: the mean of `paths_per_ray` estimates. The same, bit
// for bit, for any number of threads.
std::vector<glm::dvec3> TraceRays(const Medium& medium, const Surroundings& surroundings,
                                  const std::vector<Ray>& rays, const TraceRaysOptions& options);

}  // namespace thunderhead::reference
