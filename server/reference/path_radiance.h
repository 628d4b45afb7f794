// The radiance along a ray by one random path: null-collision free flights, sunlight by ratio
// tracking at every collision, sky and ground where the path meets them, Russian roulette.
// Unbiased: its mean is the solution of the radiative transfer equation; nothing is clamped.
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

// One estimate of the radiance that arrives at `ray`'s origin from its direction. Light scattered
// by the medium more than `max_scatterings` times is left out; 0 means no limit.
PathEstimate EstimateRadiance(const Medium& medium, const Surroundings& surroundings,
                              const Ray& ray, RandomStream* random, int max_scatterings = 0);

}  // namespace thunderhead::reference
