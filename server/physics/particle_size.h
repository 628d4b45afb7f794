// Effective radii from the mass of a mean particle, for models that count particles. Knows no
// files.
#pragma once

#include "physics/hydrometeors.h"

namespace thunderhead::physics {

// Radii beyond these are taken as missing: the limits of a scene's own.
inline constexpr float kLeastRadius_m = 1e-7F;
inline constexpr float kMostRadius_m = 0.1F;

// The effective radius of particles of default density whose mean mass is `mass_kg`. It exceeds the
// radius of the sphere of that mass by the width of the size distribution: droplets' has an
// effective variance of 0.1, as the phase tables' (r_e = r_v / 0.72^(1/3); Martin et al. 1994
// measured 0.67 to 0.80 for 0.72); the others' is exponential, as bulk microphysics assumes (r_e =
// r_v 3 / 6^(1/3)).
float EffectiveRadius_m(Hydrometeor hydrometeor, float mass_kg);

}  // namespace thunderhead::physics
