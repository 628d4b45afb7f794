// Estimates the radiance along a ray with one random path. The path uses null-collision free
// flights and Russian roulette. It gathers sunlight at every collision, and the light of sky and
// ground where it meets them. The estimate is unbiased unless PathOptions limits the number of
// scatterings or continues the path in a similar medium (Optics::kSimilar). Its mean is the
// solution of the radiative transfer equation, and nothing is clamped.
#pragma once

#include "glm/vec3.hpp"
#include "reference/medium.h"
#include "reference/philox.h"
#include "reference/surroundings.h"

namespace thunderhead::reference {

struct PathEstimate {
  glm::dvec3 radiance{0.0};
  bool met_medium = false;  // true if the path met the medium before anything else
};

struct PathOptions {
  // Largest number of scatterings by the medium. Light scattered more often is omitted. 0 means no
  // limit.
  int max_scatterings = 0;
  // Number of scatterings after which a path continues in Optics::kSimilar, which the medium must
  // have. The light gathered there is biased. 0 means never.
  int similar_after = 0;
};

// Returns one estimate of the radiance that arrives at `ray`'s origin from its direction.
PathEstimate EstimateRadiance(const Medium& medium, const Surroundings& surroundings,
                              const Ray& ray, RandomStream* random,
                              const PathOptions& options = {});

}  // namespace thunderhead::reference
