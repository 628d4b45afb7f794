// Effective radii of particles: the source that a scene selects, the papers' constants, and radii
// derived from the mass of a mean particle if a model counts particles. This code does not use
// files.
#pragma once

#include "physics/hydrometeors.h"

namespace thunderhead::physics {

// Radii outside these limits count as missing. A scene's own radii have the same limits.
inline constexpr float kMinRadius_m = 1e-7F;
inline constexpr float kMaxRadius_m = 0.1F;

// The source of the sizes of a field's particles.
enum class SizeSource {
  // The file or the scheme of its model gives the size for each cell. Otherwise it is an observed
  // constant, the radius of DefaultOptics.
  kModel,
  kPapers,  // the constants of the papers
  kGiven    // one radius that the scene gives
};

// Returns the radius of all particles by `source` for fields without a radius per cell. `given_m`
// is the scene's radius.
float ConstantRadius_m(Hydrometeor hydrometeor, SizeSource source, float given_m);

// Returns the effective radius of particles of default density with the mean mass `mass_kg`. It
// exceeds the radius r_v of the sphere of that mass by a factor that depends on the size
// distribution. Droplets have an effective variance of 0.1, as in the phase tables, so r_e = r_v /
// 0.72^(1/3). Martin et al. 1994 measured 0.67 to 0.80 for 0.72. Other particles have an
// exponential distribution, as bulk microphysics assumes, so r_e = r_v 3 / 6^(1/3).
float EffectiveRadius_m(Hydrometeor hydrometeor, float mass_kg);

}  // namespace thunderhead::physics
