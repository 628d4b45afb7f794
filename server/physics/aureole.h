// The aureole around the sun: light scattered within the forward peak of a phase function. Delta
// scaling (CutForwardPeak) cuts this peak off and counts its light as unscattered. The scattering
// angles are so small that the light stays close to the sun's ray. Only the optical depth along the
// ray matters, therefore, and n scatterings blur the disc n times (van de Hulst 1980, Multiple
// Light Scattering, section 14.1).
#pragma once

#include <vector>

#include "glm/vec3.hpp"
#include "physics/hydrometeors.h"

namespace thunderhead::physics {

// The radiance of light scattered at least twice, each time within the peak, for a sun of
// irradiance 1 behind a medium. Light that leaves the peak is not included. The radiance is the sum
// over n >= 2 of exp(-d) t^n / n! times the n-fold convolution of the cut part of the phase
// function over 4 pi. The peak's optical depth is d = t f, where t is the optical depth of all
// scattering and f is the cut share.
struct Aureole {
  static constexpr int kAngles = 128;
  static constexpr int kDepths = 32;
  static constexpr double kMaxDepth = 16.0;  // optical depth of the peak

  double share = 0.0;  // the cut share f of the luminance, as in CutForwardPeak
  // The largest angle, which is twice the cut angle. The radiance beyond it counts as zero.
  double end_rad = 0.0;
  std::vector<glm::vec3> radiances;  // kAngles by kDepths values; the angle varies fastest

  // Computes the aureole for a peak that is cut at `cut_rad`. Angle number n is end_rad (n /
  // (kAngles - 1))^2. Depth number n is kMaxDepth (n / (kDepths - 1))^2.
  static Aureole Of(const PhaseFunction& phase, double cut_rad);
};

}  // namespace thunderhead::physics
