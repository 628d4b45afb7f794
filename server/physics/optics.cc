#include "physics/optics.h"

#include <cmath>
#include <numbers>

namespace thunderhead::physics {
namespace {

// The integral of f(angle) over low..high by Simpson's rule; phase functions up to g = 0.99 need
// steps of about 0.1 degree for six digits.
template <typename F>
double IntegrateOverAngle(double low_rad, double high_rad, const F& f) {
  constexpr int kIntervals = 4096;
  const double step = (high_rad - low_rad) / kIntervals;
  double sum = f(low_rad) + f(high_rad);
  for (int i = 1; i < kIntervals; ++i) {
    sum += f(low_rad + i * step) * (i % 2 == 1 ? 4.0 : 2.0);
  }
  return sum * step / 3.0;
}

}  // namespace

glm::vec4 PhaseCoefficients(const PhaseFunction& phase) {
  switch (phase.kind) {
    case PhaseKind::kHenyeyGreenstein:
      return glsl::henyey_greenstein_coefficients(phase.asymmetry);
    case PhaseKind::kCornetteShanks:
      return glsl::cornette_shanks_coefficients(phase.asymmetry);
    case PhaseKind::kRayleigh:
      break;
  }
  return glsl::rayleigh_coefficients();
}

double PhaseValue(const PhaseFunction& phase, double mu) {
  const glm::dvec4 k = PhaseCoefficients(phase);
  const double base = k.z + k.w * (1.0 - mu);
  return (k.x + k.y * mu * mu) / (base * std::sqrt(base));
}

double CumulativePhase(const PhaseFunction& phase, double angle_rad) {
  return 0.5 * IntegrateOverAngle(0.0, angle_rad, [&](double angle) {
           return PhaseValue(phase, std::cos(angle)) * std::sin(angle);
         });
}

double MeanCosine(const PhaseFunction& phase) {
  return 0.5 * IntegrateOverAngle(0.0, std::numbers::pi, [&](double angle) {
           return PhaseValue(phase, std::cos(angle)) * std::cos(angle) * std::sin(angle);
         });
}

DeltaScaling CutForwardPeak(const PhaseFunction& phase, double angle_rad) {
  const double cut_cosine = std::cos(angle_rad);
  const double within = CumulativePhase(phase, angle_rad);
  const double held = 0.5 * PhaseValue(phase, cut_cosine) * (1.0 - cut_cosine);
  return {std::fmax(within - held, 0.0), cut_cosine};
}

}  // namespace thunderhead::physics
