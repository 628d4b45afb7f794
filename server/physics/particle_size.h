// Effective radii of particles. A scene selects their source: the model's file or scheme, the
// papers' constants, or one given radius. If a model counts particles, radii are derived from the
// mass of a mean particle. This code does not use files.
#pragma once

#include "physics/hydrometeors.h"

namespace thunderhead::physics {

// Radii outside these limits count as missing. A scene's own radii have the same limits.
inline constexpr float kMinRadius_m = 1e-7F;
inline constexpr float kMaxRadius_m = 0.1F;

// The source of the sizes of a field's particles.
enum class SizeSource {
  // The file or the model's microphysics scheme gives a size for each cell. If neither does, the
  // size is an observed constant, the radius of DefaultOptics.
  kModel,
  kPapers,  // the constants of Riley et al. 2003 (PapersRadius_m)
  kGiven    // one radius, given by the scene
};

// Returns the radius that `source` gives to all particles of a field without a radius for each
// cell. `given_m` is the scene's radius.
float ConstantRadius_m(Hydrometeor hydrometeor, SizeSource source, float given_m);

// Returns the effective radius r_e of particles of default density with the mean mass `mass_kg`. A
// sphere of that mass has the radius r_v. The ratio of r_e to r_v depends on the size distribution.
// Cloud droplets have an effective variance of 0.1, as in the phase tables, so r_e = r_v /
// 0.72^(1/3). Martin et al. 1994 measured values from 0.67 to 0.80 in place of 0.72. Other
// particles have an exponential distribution, as bulk microphysics assumes, so r_e = r_v 3 /
// 6^(1/3).
float EffectiveRadius_m(Hydrometeor hydrometeor, float mass_kg);

}  // namespace thunderhead::physics
