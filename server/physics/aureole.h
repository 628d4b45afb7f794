// Light scattered within the forward peak that delta scaling cuts off and counts as unscattered
// (CutForwardPeak): the aureole around the sun. Its angles are so small that the light stays next
// to the sun's ray, so that only the optical depth along the ray counts, and n scatterings blur the
// disc n times: van de Hulst 1980, Multiple Light Scattering, section 14.1.
#pragma once

#include <vector>

#include "glm/vec3.hpp"
#include "physics/hydrometeors.h"

namespace thunderhead::physics {

// Radiance of light scattered at least twice within the peak, and never else, for a sun of
// irradiance 1 behind a medium whose light outside the peak is left out of account: the sum over n
// from 2 on of exp(-d) t^n / n! times the n-fold convolution of the cut part of the phase function
// over 4 pi. d = t f is the peak's optical depth, t that of all scattering, f the share cut off.
struct Aureole {
  static constexpr int kAngles = 128;
  static constexpr int kDepths = 32;
  static constexpr double kMaxDepth = 16.0;  // of the peak

  double share = 0.0;                // f; luminance, as CutForwardPeak's
  double end_rad = 0.0;              // there is none beyond this angle: twice the cut
  std::vector<glm::vec3> radiances;  // kAngles by kDepths, angles first

  // The peak is cut at `cut_rad`. The nth angle is end_rad (n / (kAngles - 1))^2, the nth depth
  // kMaxDepth (n / (kDepths - 1))^2.
  static Aureole Of(const PhaseFunction& phase, double cut_rad);
};

}  // namespace thunderhead::physics
