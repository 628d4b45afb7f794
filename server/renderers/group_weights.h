// Weights of each group of a medium (fields with equal optics) in the sums of light transport. The
// weights are factors of the group's extinction that give its extinction for the eye and the light,
// and its scattering. The class also holds the parameters of the phase functions' cut and display.
// Light buffers have no colours, so a phase function with different values for red, green and blue
// enters the weights by its luminance. The renderers that follow Riley et al. 2003 (Vis), section
// 4.4, share this code.
#pragma once

#include <vector>

#include "gl/program.h"
#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "renderers/medium.h"
#include "renderers/render_settings.h"
#include "scene/scene.h"

namespace thunderhead::renderers {

// Vectors with one value for each group. A value is a factor of the group's extinction unless
// stated otherwise.
struct GroupWeights {
  std::vector<double> eye;  // extinction along the eye's ray, delta scaled like `light`
  // Extinction along the sun's ray. It is delta scaled if the transport is translucent and not the
  // paper's.
  std::vector<double> light;
  std::vector<double> scattering;  // albedo
  std::vector<double> transport;   // extinction scaled by similarity: 1 - omega g
  std::vector<double> diffusing;   // scattering scaled by similarity: omega (1 - g)
  std::vector<double> absorption;  // absorption, 1 - omega
  // Scattering by angles from theta_f / 4 to theta_f / 2, the outer ring around the forward
  // direction (theta_f is MediumSettings::theta_f_deg).
  std::vector<double> peripheral;
  // Offset and slope with which the paper normalises phase functions for display.
  std::vector<glm::vec2> phase_display;
  std::vector<glm::vec3> color;
  bool colored = false;
  bool absorbs = false;
  bool even_albedo = true;  // all groups have the same albedo and no colours
  float phase_cut = 0.0F;   // haversine of the angle within which phase functions are cut
  // Cumulative phase function of the first group at theta_f / 4 and theta_f / 2 (Vis eq. 13). Only
  // the paper's transport uses it, for the light of all groups, as the paper does.
  glm::vec2 cumulative_phase{0.0F};

  GroupWeights(const Medium& medium, const scene::MediumSettings& settings);

  // Sets the uniforms of common/phase.glsl.
  void BindPhase(const gl::Program& program) const;
  // Sets the uniforms of common/phase.glsl and common/scattered.glsl. `medium` must be the medium
  // from which these weights were computed.
  void BindScattered(const gl::Program& program, const ResidentMedium& medium,
                     const Illumination& illumination) const;
};

}  // namespace thunderhead::renderers
