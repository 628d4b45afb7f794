// Phase functions and closed forms of light transport. The formulas are GLSL that also compiles
// here, so that what the tests check is what the GPU runs; what only the CPU needs (integrals of a
// phase function) is beside them.
#pragma once

#include "glm/common.hpp"
#include "glm/exponential.hpp"
#include "glm/vec3.hpp"
#include "glm/vec4.hpp"
#include "physics/hydrometeors.h"

namespace thunderhead::physics {
namespace glsl {

using glm::abs;
using glm::exp;
using glm::max;
using glm::min;
using glm::sqrt;
using glm::vec3;
using glm::vec4;
#include "shaders/physics/light_transport.glsl"
#include "shaders/physics/phase_functions.glsl"

}  // namespace glsl

// The coefficients of `phase` for glsl::phase_value. An asymmetry beyond +-0.99 is not allowed.
glm::vec4 PhaseCoefficients(const PhaseFunction& phase);

// The value of `phase` at the cosine of a scattering angle; its mean over the sphere is 1.
double PhaseValue(const PhaseFunction& phase, double mu);

// The share of light scattered within `angle_rad` of straight on: CP(theta) of Riley et al. 2003
// (Vis), eq. 13. 0 at 0, 1 at pi.
double CumulativePhase(const PhaseFunction& phase, double angle_rad);

// The mean cosine of the scattering angle, from -1 to 1.
double MeanCosine(const PhaseFunction& phase);

// A phase function split into light that goes straight on and the rest: within `angle_rad` of
// straight on the function is held at its value there, and what is cut off counts as not scattered
// at all (delta scaling). `forward_share` is the share cut off, 0 to 1.
struct DeltaScaling {
  double forward_share = 0.0;
  double cut_cosine = 1.0;
};
DeltaScaling CutForwardPeak(const PhaseFunction& phase, double angle_rad);

}  // namespace thunderhead::physics
