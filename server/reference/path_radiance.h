// The radiance along a ray by one random path: null-collision free flights, sunlight at every
// collision, sky and ground where the path meets them, Russian roulette. Unbiased, unless it goes
// on in a similar medium: its mean is the solution of the radiative transfer equation; nothing is
// clamped.
#pragma once

#include "glm/vec3.hpp"
#include "reference/medium.h"
#include "reference/philox.h"
#include "reference/surroundings.h"

namespace thunderhead::reference {

struct PathEstimate {
  glm::dvec3 radiance{0.0};
  bool met_medium = false;  // before anything else
};

struct PathOptions {
  // Light scattered by the medium more often is left out; 0: no limit.
  int max_scatterings = 0;
  // After this many scatterings a path goes on in Optics::kSimilar, which the medium must have; 0:
  // never. What it then finds is biased.
  int similar_after = 0;
};

// One estimate of the radiance that arrives at `ray`'s origin from its direction.
PathEstimate EstimateRadiance(const Medium& medium, const Surroundings& surroundings,
                              const Ray& ray, RandomStream* random,
                              const PathOptions& options = {});

}  // namespace thunderhead::reference
