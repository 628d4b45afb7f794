// Phase functions, as formulas and as tables, and closed forms of light transport. Code that the
// GPU also runs is GLSL that compiles as C++ too, so that the tests check the same text. This
// header adds code that only the CPU runs: phase functions, which the GPU reads from tables, and
// their integrals.
#pragma once

#include "glm/common.hpp"
#include "glm/exponential.hpp"
#include "glm/vec3.hpp"
#include "physics/hydrometeors.h"

namespace thunderhead::physics {
namespace glsl {

using glm::abs;
using glm::exp;
using glm::max;
using glm::min;
using glm::sqrt;
#include "shaders/physics/light_transport.glsl"
#include "shaders/physics/phase_curve.glsl"

}  // namespace glsl

// A phase function given by a formula.
struct PhaseFormula {
  PhaseKind kind;
  bool has_asymmetry;  // whether `value` depends on the asymmetry parameter g
  // Returns the value of the phase function at the cosine `mu` of the scattering angle. All colours
  // have the same value. Its mean over the sphere is 1.
  double (*value)(double g, double mu);
};

// Returns the formula of `kind`, or null for a kind that is a table.
const PhaseFormula* FormulaOf(PhaseKind kind);

// Returns the phase function of a field's particles in canonical form, so that equal functions
// compare equal. Parameters that its kind does not use are zero. droplet_radius_m is the radius of
// the nearest table (by ratio).
PhaseFunction PhaseOf(const ParticleOptics& optics);

// Weights of the luminance of linear sRGB. Code without colours uses the luminance instead of three
// values.
inline constexpr glm::dvec3 kLuminance{0.2126, 0.7152, 0.0722};

// Returns the value of `phase` at the cosine of a scattering angle, for red, green and blue. Its
// mean over the sphere is 1.
glm::dvec3 PhaseColors(const PhaseFunction& phase, double mu);

// Returns the luminance of PhaseColors. The results of the functions below are luminances as well,
// not one value for each colour.
double PhaseValue(const PhaseFunction& phase, double mu);

// Returns the share of light scattered by less than `angle_rad`, which is CP(theta) of Riley et al.
// 2003 (Vis), eq. 13. The share is 0 at an angle of 0 and 1 at pi.
double CumulativePhase(const PhaseFunction& phase, double angle_rad);

// Returns the mean cosine of the scattering angle, from -1 to 1.
double MeanCosine(const PhaseFunction& phase);

// Delta scaling of a phase function. At angles below `angle_rad`, the function is replaced by its
// value at `angle_rad`. The light that this cuts off counts as not scattered. `forward_share` is
// its share of the scattered light, 0 to 1.
struct DeltaScaling {
  double forward_share = 0.0;
  double cut_cosine = 1.0;
};
DeltaScaling CutForwardPeak(const PhaseFunction& phase, double angle_rad);

}  // namespace thunderhead::physics
