#include "renderers/group_weights.h"

#include <algorithm>
#include <cmath>

#include "glm/trigonometric.hpp"
#include "physics/optics.h"

namespace thunderhead::renderers {
namespace {

// The paper's display normalisation: the logarithm of the cut phase function over its dynamic
// range, 0 to 1.
glm::vec2 DisplayNormalisation(const physics::PhaseFunction& phase, double cut_cosine) {
  double low = physics::PhaseValue(phase, cut_cosine);
  double high = low;
  for (int i = 0; i <= 1800; ++i) {
    const double mu = std::min(std::cos(glm::radians(0.1 * i)), cut_cosine);
    low = std::min(low, physics::PhaseValue(phase, mu));
    high = std::max(high, physics::PhaseValue(phase, mu));
  }
  if (high - low < 1e-6 * high) return {1.0F, 0.0F};
  const double slope = 1.0 / (1.0 + std::log(high / low));
  return {static_cast<float>((1.0 - std::log(low)) * slope), static_cast<float>(slope)};
}

}  // namespace

bool IsTranslucent(const scene::Rendering& rendering) {
  return rendering.mode != scene::Mode::kUniformPhaseLowAlbedo;
}

bool IsConsistent(const scene::Rendering& rendering) {
  return rendering.transport == scene::Transport::kConsistent;
}

GroupWeights::GroupWeights(const Medium& medium, const scene::Rendering& rendering) {
  const double theta_f = glm::radians(rendering.theta_f_deg);
  const bool delta_scaled = IsConsistent(rendering) && IsTranslucent(rendering);
  for (const MediumGroup& group : medium.groups) {
    const physics::DeltaScaling cut = physics::CutForwardPeak(group.phase, theta_f / 2.0);
    const double passed = delta_scaled ? group.albedo * cut.forward_share : 0.0;
    const double ring = physics::CumulativePhase(group.phase, theta_f / 2.0) -
                        physics::CumulativePhase(group.phase, theta_f / 4.0);
    eye.push_back(1.0 - passed);
    light.push_back(1.0 - passed);
    scattering.push_back(group.albedo);
    transport.push_back(1.0 - group.albedo * physics::MeanCosine(group.phase));
    peripheral.push_back(group.albedo * ring);
    phase.push_back(physics::PhaseCoefficients(group.phase));
    const bool whole = IsConsistent(rendering) && !IsTranslucent(rendering);
    phase_cut.push_back(whole ? 1.0F : static_cast<float>(cut.cut_cosine));
    phase_display.push_back(DisplayNormalisation(group.phase, cut.cut_cosine));
    color.push_back(group.color);
    colored = colored || group.color != glm::vec3(1.0F);
  }
  const physics::PhaseFunction& first = medium.groups.front().phase;
  cumulative_phase = {physics::CumulativePhase(first, theta_f / 4.0),
                      physics::CumulativePhase(first, theta_f / 2.0)};
}

void GroupWeights::BindPhase(const gl::Program& program) const {
  program.Set("phase", phase);
  program.Set("phase_cut", phase_cut);
  program.Set("phase_display", phase_display);
  program.Set("group_color", color);
}

}  // namespace thunderhead::renderers
