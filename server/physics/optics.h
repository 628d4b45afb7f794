// Phase functions, by formula and by table, and closed forms of light transport. Code that the GPU
// runs as well is GLSL that also compiles as C++, so that the tests check the same text; code for
// the CPU alone (phase functions, which the GPU looks up, and their integrals) is beside it.
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

// A phase function by a formula.
struct PhaseFormula {
  PhaseKind kind;
  bool has_asymmetry;  // whether `value` depends on the asymmetry parameter g
  // The value at the cosine `mu` of a scattering angle, the same for all colours. The mean over the
  // sphere is 1.
  double (*value)(double g, double mu);
};

// Returns the formula of `kind`, or null for a kind that is a table.
const PhaseFormula* FormulaOf(PhaseKind kind);

// The phase function of a field's particles in canonical form, so that equal functions compare
// equal: parameters that its kind does not use are zero, and the droplets' radius is that of the
// nearest table (by ratio).
PhaseFunction PhaseOf(const ParticleOptics& optics);

// Where light has no colours, one value stands for three: the luminance of linear sRGB. Formulas
// have one value for all colours.
inline constexpr glm::dvec3 kLuminance{0.2126, 0.7152, 0.0722};

// The value of `phase` at the cosine of a scattering angle, for red, green and blue; its mean over
// the sphere is 1.
glm::dvec3 PhaseColors(const PhaseFunction& phase, double mu);

// The same as a single value, as all below: the luminance of the colours.
double PhaseValue(const PhaseFunction& phase, double mu);

// The share of light scattered by less than `angle_rad`: CP(theta) of Riley et al. 2003 (Vis), eq.
// 13. 0 at 0, 1 at pi.
double CumulativePhase(const PhaseFunction& phase, double angle_rad);

// The mean cosine of the scattering angle, from -1 to 1.
double MeanCosine(const PhaseFunction& phase);

// Delta scaling of a phase function: for angles below `angle_rad` it is held at its value there,
// and the light so cut off counts as not scattered at all. `forward_share` is the share cut off, 0
// to 1.
struct DeltaScaling {
  double forward_share = 0.0;
  double cut_cosine = 1.0;
};
DeltaScaling CutForwardPeak(const PhaseFunction& phase, double angle_rad);

}  // namespace thunderhead::physics
