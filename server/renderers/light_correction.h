// Factors for the storm's radiance in a light volume's picture, by place and direction, fitted to
// the reference (accuracy/correction_fit.h): a plain value. Each ray looks its factor up once, at
// the mean place of what it sees. Knows no GL.
#pragma once

#include <array>
#include <vector>

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "glm/vec4.hpp"

namespace thunderhead::renderers {

struct LightCorrection {
  // Texels over the medium's box, x fastest.
  glm::ivec3 size{0};
  // For red, green and blue: the factor for a ray of direction d is dot(texel, (1, d)).
  std::array<std::vector<glm::vec4>, 3> texels;

  // Factors for skylight on level ground, which the storm hides in part and to which it adds its
  // own: red, green and blue of texels over a rectangle of the world, x fastest.
  glm::ivec2 ground_size{0};
  std::vector<glm::vec4> ground;
  glm::dvec2 ground_low_m{0.0};
  glm::dvec2 ground_high_m{0.0};
};

}  // namespace thunderhead::renderers
