// Weights of each group of a medium in the sums of light transport. They are shares of its
// extinction for the eye and the light, its scattering, and the parameters of its phase function's
// cut and display. Light buffers have no colours, so extinctions follow from the luminance of a
// phase function's colours. The renderers that follow Riley et al. 2003 (Vis), section 4.4, share
// this code.
#pragma once

#include <vector>

#include "gl/program.h"
#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "renderers/medium.h"
#include "renderers/render_settings.h"
#include "scene/scene.h"

namespace thunderhead::renderers {

// One value a group. It is a share of the group's extinction unless stated otherwise.
struct GroupWeights {
  std::vector<double> eye;  // extinction along the eye's ray
  // Extinction along the sun's ray; delta scaled if consistent.
  std::vector<double> light;
  std::vector<double> scattering;  // albedo
  std::vector<double> transport;   // similarity-scaled extinction, 1 - omega g
  std::vector<double> diffusing;   // similarity-scaled scattering, omega (1 - g)
  std::vector<double> absorption;  // absorption, 1 - omega
  // Scattering into the outer ring around the forward direction.
  std::vector<double> peripheral;
  std::vector<glm::vec2> phase_display;  // offset and slope of the paper's display normalisation
  std::vector<glm::vec3> color;
  bool colored = false;
  bool absorbs = false;
  bool even_albedo = true;           // all groups have one albedo and no colours
  float phase_cut = 0.0F;            // haversine of the angle within which phase functions are cut
  glm::vec2 cumulative_phase{0.0F};  // CP(theta_f / 4), CP(theta_f / 2): Vis eq. 13

  GroupWeights(const Medium& medium, const scene::MediumSettings& settings);

  // Sets the uniforms of common/phase.glsl.
  void BindPhase(const gl::Program& program) const;
  // Sets those of common/phase.glsl and common/scattered.glsl. `medium` must be the medium of these
  // weights.
  void BindScattered(const gl::Program& program, const ResidentMedium& medium,
                     const Illumination& illumination) const;
};

}  // namespace thunderhead::renderers
