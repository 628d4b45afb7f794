// Effective radii of particles: which of them a scene shows, the papers' constants, and those that
// follow from the mass of a mean particle where a model counts particles. Knows no files.
#pragma once

#include "physics/hydrometeors.h"

namespace thunderhead::physics {

// Radii outside are taken as missing; the same limits as for a scene's own radii.
inline constexpr float kMinRadius_m = 1e-7F;
inline constexpr float kMaxRadius_m = 0.1F;

// Where the sizes of a field's particles come from.
enum class SizeSource {
  // The file or the scheme of its model, for each cell; else an observed constant, the radius of
  // DefaultOptics.
  kModel,
  kPapers,  // the constants of the papers
  kGiven    // one radius that the scene gives
};

// The radius of all particles by `source` where no cell has its own; `given_m` is the scene's.
float ConstantRadius_m(Hydrometeor hydrometeor, SizeSource source, float given_m);

// The effective radius of particles of default density whose mean mass is `mass_kg`. It is larger
// than the radius r_v of the sphere of that mass, depending on the size distribution. Droplets:
// effective variance 0.1, as in the phase tables, r_e = r_v / 0.72^(1/3) (for 0.72 Martin et al.
// 1994 measured 0.67 to 0.80). Others: exponential, as bulk microphysics assumes, r_e = r_v 3 /
// 6^(1/3).
float EffectiveRadius_m(Hydrometeor hydrometeor, float mass_kg);

}  // namespace thunderhead::physics
