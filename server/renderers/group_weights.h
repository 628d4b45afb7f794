// Weights of each group of a medium in the sums of light transport: shares of its extinction
// for the eye and the light, its scattering, and how its phase function is cut and displayed. Light
// buffers have no colours, so extinctions follow from the luminance of a phase function's colours.
// Shared by the renderers that follow Riley et al. 2003 (Vis), section 4.4.
#pragma once

#include <vector>

#include "gl/program.h"
#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "renderers/medium.h"
#include "renderers/render_settings.h"
#include "scene/scene.h"

namespace thunderhead::renderers {

// One value a group, as a share of the group's extinction, where not said otherwise.
struct GroupWeights {
  std::vector<double> eye;               // extinction of the eye's ray
  std::vector<double> light;             // extinction of the sun's ray, delta scaled if consistent
  std::vector<double> scattering;        // albedo
  std::vector<double> transport;         // similarity-scaled extinction, 1 - omega g
  std::vector<double> diffusing;         // similarity-scaled scattering, omega (1 - g)
  std::vector<double> absorption;        // 1 - omega
  std::vector<double> peripheral;        // scattering into the outer ring around straight on
  std::vector<glm::vec2> phase_display;  // offset and slope of the paper's display normalisation
  std::vector<glm::vec3> color;
  bool colored = false;
  bool absorbs = false;
  bool even_albedo = true;           // one albedo for all groups, and no colours
  float phase_cut = 0.0F;            // haversine within which phase functions are held
  glm::vec2 cumulative_phase{0.0F};  // CP(theta_f / 4), CP(theta_f / 2): Vis eq. 13

  GroupWeights(const Medium& medium, const scene::MediumSettings& settings);

  // Sets the uniforms of common/phase.glsl.
  void BindPhase(const gl::Program& program) const;
  // Those, and the ones of common/scattered.glsl. `medium` is the one that the weights are of.
  void BindScattered(const gl::Program& program, const ResidentMedium& medium,
                     const Illumination& illumination) const;
};

}  // namespace thunderhead::renderers
