// The aureole around the sun: light scattered within the forward peak, which delta scaling cuts off
// and counts as unscattered (CutForwardPeak). Its angles are so small that the light stays close to
// the sun's ray. Therefore only the optical depth along the ray matters, and n scatterings blur the
// disc n times (van de Hulst 1980, Multiple Light Scattering, section 14.1).
#pragma once

#include <vector>

#include "glm/vec3.hpp"
#include "physics/hydrometeors.h"

namespace thunderhead::physics {

// Radiance of light scattered at least twice, always within the peak, for a sun of irradiance 1
// behind a medium. Light that leaves the peak is not included. It is the sum over n >= 2 of exp(-d)
// t^n / n! times the n-fold convolution of the cut part of the phase function over 4 pi. The peak's
// optical depth is d = t f, where t is the depth of all scattering and f the share cut off.
struct Aureole {
  static constexpr int kAngles = 128;
  static constexpr int kDepths = 32;
  static constexpr double kMaxDepth = 16.0;  // optical depth of the peak

  double share = 0.0;  // f, by luminance, as CutForwardPeak's
  // The largest angle, twice the cut; the radiance beyond it is zero.
  double end_rad = 0.0;
  std::vector<glm::vec3> radiances;  // kAngles by kDepths, angles first

  // Computes the aureole for a peak that is cut at `cut_rad`. The nth angle is end_rad (n /
  // (kAngles - 1))^2, the nth depth kMaxDepth (n / (kDepths - 1))^2.
  static Aureole Of(const PhaseFunction& phase, double cut_rad);
};

}  // namespace thunderhead::physics
