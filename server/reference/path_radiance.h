// Estimates the radiance along a ray with one random path. It uses null-collision free flights,
// sunlight at every collision, sky and ground where the path meets them, and Russian roulette. The
// estimate is unbiased unless the path continues in a similar medium. Its mean is the solution of
// the radiative transfer equation, and nothing is clamped.
#pragma once

#include "glm/vec3.hpp"
#include "reference/medium.h"
#include "reference/philox.h"
#include "reference/surroundings.h"

namespace thunderhead::reference {

struct PathEstimate {
  glm::dvec3 radiance{0.0};
  bool met_medium = false;  // true: the path met the medium before anything else
};

struct PathOptions {
  // Light that the medium scatters more often is omitted. 0: no limit.
  int max_scatterings = 0;
  // After this many scatterings a path continues in Optics::kSimilar, which the medium must have.
  // The light found there is biased. 0: never.
  int similar_after = 0;
};

// Returns one estimate of the radiance that arrives at `ray`'s origin from its direction.
PathEstimate EstimateRadiance(const Medium& medium, const Surroundings& surroundings,
                              const Ray& ray, RandomStream* random,
                              const PathOptions& options = {});

}  // namespace thunderhead::reference
