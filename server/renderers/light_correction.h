// Factors that correct the storm's radiance in a light volume's picture, by place and direction.
// They are fitted to path-traced radiance (accuracy/correction_fit.h). Each ray looks up its factor
// once, at the mean place of the parts of the storm that it shows. The type is a plain value and
// does not use GL.
#pragma once

#include <array>
#include <vector>

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "glm/vec4.hpp"

namespace thunderhead::renderers {

struct LightCorrection {
  // Number of texels over the medium's box, with x varying fastest.
  glm::ivec3 size{0};
  // Coefficients for red, green and blue. The factor for a ray of direction d is the dot product of
  // the texel and (1, d).
  std::array<std::vector<glm::vec4>, 3> texels;

  // Factors for skylight on level ground. The storm hides a part of the sky and adds its own light.
  // The texels hold red, green and blue factors over a rectangle of the world, with x varying
  // fastest.
  glm::ivec2 ground_size{0};
  std::vector<glm::vec4> ground;
  glm::dvec2 ground_low_m{0.0};
  glm::dvec2 ground_high_m{0.0};
};

}  // namespace thunderhead::renderers
