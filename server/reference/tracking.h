// Free flights in a heterogeneous medium by null collisions (Woodcock et al. 1965), and
// transmittances from brick to brick. Both are unbiased and have no quadrature errors. This code
// does not depend on light sources.
#pragma once

#include <optional>

#include "glm/vec3.hpp"
#include "reference/brick_walk.h"
#include "reference/medium.h"
#include "reference/philox.h"

namespace thunderhead::reference {

// Returns the distance to the first real collision along `ray`. Returns nothing if there is no
// collision within `limit_m`, which may be infinite.
std::optional<double> SampleCollision(const Medium& medium, const Ray& ray, double limit_m,
                                      RandomStream* random, Optics optics = Optics::kExact);

// Returns an unbiased estimate, at least 0, of the transmittance along `ray` up to `limit_m`. The
// estimate is exact up to an optical depth of 1. Beyond it, the ray continues by Russian roulette.
double EstimateTransmittance(const Medium& medium, const Ray& ray, double limit_m,
                             RandomStream* random, Optics optics = Optics::kExact);

// Returns the unit vector at an angle of cosine `mu` from `direction`, rotated about it by
// `azimuth_rad`.
glm::dvec3 Deflect(const glm::dvec3& direction, double mu, double azimuth_rad);

// Returns a unit vector distributed uniformly over the upper hemisphere.
glm::dvec3 SampleUpward(RandomStream* random);

// Returns a random unit vector about `normal`, with a density proportional to the cosine of its
// angle to `normal`.
glm::dvec3 SampleCosine(const glm::dvec3& normal, RandomStream* random);

}  // namespace thunderhead::reference
