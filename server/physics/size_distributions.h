// The size distributions that the microphysics schemes of models assume. They give particle sizes
// for a model that outputs only mass. This code does not use files.
#pragma once

#include <string_view>

#include "physics/hydrometeors.h"

namespace thunderhead::physics {

enum class Microphysics { kUnknown, kWsm6, kWsm6WithHail, kThompson };

// Returns "WSM6", "WSM6 with hail", "Thompson", or "" if unknown.
std::string_view NameOf(Microphysics microphysics);

// Returns true if this code knows the distribution that the scheme assumes for these particles.
bool HasDistribution(Microphysics microphysics, Hydrometeor hydrometeor);

// Returns the effective radius (m) of the particles in air that holds `content_kg_per_m3` of them
// (above zero). Only the size of snow depends on `temperature_K`. If the scheme's particle density
// differs from that of DefaultOptics, the result is the radius of particles of the default density
// with the same mass extinction. The result lies between kMinRadius_m and kMaxRadius_m.
// HasDistribution must be true for the scheme and the hydrometeor.
//
// WSM6 follows Hong and Lim 2006, with the limits of WRF's mp_wsm6_effectRad. With WRF's option
// HAIL_OPT, its graupel has the intercept and density of hail. Its snow consists of spheres of 100
// kg/m3, and the scheme derives the slope of the distribution from the mass of these spheres. Their
// mass extinction at 1 mm, 30 m2/kg, equals that of observed aggregates (Mitchell 1996: 27 m2/kg).
// WRF passes 0.5 / slope to its radiation code instead. That is a third of the radius returned
// here, and suits optics with the density of solid ice.
//
// Thompson follows Thompson et al. 2008. Cloud droplets are as in calc_effectRad of WRF 4.7, and
// graupel has the intercept of that version. The scheme predicts the number of rain and ice
// particles, so these have no distribution here. Snow has none either. The scheme gives its mass
// for each diameter and the moments of its distribution (Field et al. 2005), but not its area, on
// which extinction depends.
float DistributionRadius_m(Microphysics microphysics, Hydrometeor hydrometeor,
                           float content_kg_per_m3, float temperature_K);

}  // namespace thunderhead::physics
