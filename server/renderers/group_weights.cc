#include "renderers/group_weights.h"

#include <algorithm>
#include <cmath>

#include "glm/common.hpp"
#include "glm/trigonometric.hpp"
#include "physics/optics.h"
#include "renderers/sunlight.h"
#include "shaders/uniforms.h"

namespace thunderhead::renderers {
namespace {

// Returns offset and slope of the paper's display normalisation. Applied to the logarithm of the
// cut phase function, they give 1 for its highest value of all colours, and 1 / (1 + log(highest /
// lowest)) for its lowest.
glm::vec2 DisplayNormalisation(const physics::PhaseFunction& phase, double cut_cosine) {
  glm::dvec3 lowest = physics::PhaseColors(phase, cut_cosine);
  glm::dvec3 highest = lowest;
  for (int i = 0; i <= 1800; ++i) {
    const double mu = std::min(std::cos(glm::radians(0.1 * i)), cut_cosine);
    const glm::dvec3 colors = physics::PhaseColors(phase, mu);
    lowest = glm::min(lowest, colors);
    highest = glm::max(highest, colors);
  }
  const double low = std::min({lowest.r, lowest.g, lowest.b});
  const double high = std::max({highest.r, highest.g, highest.b});
  if (high - low < 1e-6 * high) return {1.0F, 0.0F};
  const double slope = 1.0 / (1.0 + std::log(high / low));
  return {static_cast<float>((1.0 - std::log(low)) * slope), static_cast<float>(slope)};
}

}  // namespace

GroupWeights::GroupWeights(const Medium& medium, const scene::MediumSettings& settings) {
  const double theta_f = glm::radians(settings.theta_f_deg);
  const bool paper = scene::IsPaper(settings.transport);
  const bool translucent = scene::IsTranslucent(settings.transport);
  const bool delta_scaled = !paper && translucent;
  for (const MediumGroup& group : medium.groups) {
    const physics::DeltaScaling cut = physics::CutForwardPeak(group.phase, theta_f / 2.0);
    const double forward_scattered = delta_scaled ? group.albedo * cut.forward_share : 0.0;
    const double ring = physics::CumulativePhase(group.phase, theta_f / 2.0) -
                        physics::CumulativePhase(group.phase, theta_f / 4.0);
    eye.push_back(1.0 - forward_scattered);
    light.push_back(1.0 - forward_scattered);
    scattering.push_back(group.albedo);
    const double mean_cosine = physics::MeanCosine(group.phase);
    transport.push_back(1.0 - group.albedo * mean_cosine);
    diffusing.push_back(group.albedo * (1.0 - mean_cosine));
    absorption.push_back(1.0 - group.albedo);
    absorbs = absorbs || group.albedo < 1.0F;
    peripheral.push_back(group.albedo * ring);
    phase_display.push_back(paper ? DisplayNormalisation(group.phase, cut.cut_cosine)
                                  : glm::vec2(0.0F));
    color.push_back(group.color);
    colored = colored || group.color != glm::vec3(1.0F);
    even_albedo = even_albedo && group.albedo == medium.groups.front().albedo;
  }
  even_albedo = even_albedo && !colored;
  const bool whole = !paper && !translucent;
  phase_cut = whole ? 0.0F : static_cast<float>(std::pow(std::sin(theta_f / 4.0), 2.0));
  // Light buffers have one channel for all groups, and Riley et al. give one cumulative phase
  // function for all particles, because all of them scatter mainly forwards.
  const physics::PhaseFunction& first = medium.groups.front().phase;
  cumulative_phase = {physics::CumulativePhase(first, theta_f / 4.0),
                      physics::CumulativePhase(first, theta_f / 2.0)};
}

void GroupWeights::BindPhase(const gl::Program& program) const {
  program.Set(uniform::phase_cut, phase_cut);
  program.Set(uniform::phase_display, phase_display);
  program.Set(uniform::group_color, color);
}

void GroupWeights::BindScattered(const gl::Program& program, const ResidentMedium& medium,
                                 const Illumination& illumination) const {
  BindPhase(program);
  program.Set(uniform::scattering_weights, medium.Weights(scattering));
  program.Set(uniform::albedo, medium.Content().groups.front().albedo);
  BindSunlight(program, illumination, medium.Middle_m().z);
  program.Set(uniform::ambient, illumination.ambient);
}

}  // namespace thunderhead::renderers
