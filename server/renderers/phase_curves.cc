#include "renderers/phase_curves.h"

#include <cmath>

#include "glm/vec4.hpp"
#include "physics/optics.h"
#include "shaders/bindings.h"

namespace thunderhead::renderers {
namespace {

// Number of texels of a curve. The step between them is 0.03 degrees at the 22 degree halo, 0.08
// degrees at the rainbow and 7e-6 degrees at the first texel.
constexpr int kTexels = 4096;

// Returns the cosine of the scattering angle at a place on the curve. It is the inverse of
// glsl::phase_curve_place.
double CosineAt(double place) {
  const double share = place * place;
  const double half_angle = std::atan2(share, 1.0 - share);
  return std::cos(2.0 * half_angle);
}

}  // namespace

PhaseCurves::PhaseCurves(const std::vector<physics::PhaseFunction>& phases)
    : texture_(GL_RGBA32F, {kTexels, static_cast<int>(phases.size())}) {
  std::vector<glm::vec4> texels;
  texels.reserve(kTexels * phases.size());
  for (const physics::PhaseFunction& phase : phases) {
    for (int i = 0; i < kTexels; ++i) {
      const double mu = CosineAt(static_cast<double>(i) / (kTexels - 1));
      texels.emplace_back(glm::vec3(physics::PhaseColors(phase, mu)), 1.0F);
    }
  }
  texture_.Upload(GL_RGBA, GL_FLOAT, texels.data());
}

void PhaseCurves::Bind() const { texture_.Bind(shaders::kPhaseCurvesUnit); }

}  // namespace thunderhead::renderers
