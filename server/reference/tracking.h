// Free flights in a heterogeneous medium by null collisions (Woodcock et al. 1965), and
// transmittances from brick to brick: unbiased, without errors of quadrature. Knows no light.
#pragma once

#include <optional>

#include "glm/vec3.hpp"
#include "reference/brick_walk.h"
#include "reference/medium.h"
#include "reference/philox.h"

namespace thunderhead::reference {

// The distance to the first real collision along `ray`, or nothing if there is none within
// `limit_m` (may be infinite).
std::optional<double> SampleCollision(const Medium& medium, const Ray& ray, double limit_m,
                                      RandomStream* random, Optics optics = Optics::kExact);

// An unbiased estimate, at least 0, of the transmittance along `ray` up to `limit_m`: exact unless
// it is small, as beyond an optical depth of 1 the ray goes on by Russian roulette.
double EstimateTransmittance(const Medium& medium, const Ray& ray, double limit_m,
                             RandomStream* random, Optics optics = Optics::kExact);

// The unit vector at an angle of cosine `mu` from `direction`, turned about it by `azimuth_rad`.
glm::dvec3 Deflect(const glm::dvec3& direction, double mu, double azimuth_rad);

// A unit vector spread evenly over the upper half.
glm::dvec3 SampleUpward(RandomStream* random);

// A unit vector about `normal` with a density in proportion to the cosine between the two.
glm::dvec3 SampleCosine(const glm::dvec3& normal, RandomStream* random);

}  // namespace thunderhead::reference
