// What every renderer of a medium is told besides the medium.
#pragma once

#include "gl/objects.h"
#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "scene/scene.h"
#include "scene/view.h"

namespace thunderhead::renderers {

// What the sun and sky send into the medium.
struct Illumination {
  glm::dvec3 towards_sun{0.0, 0.0, 1.0};
  glm::vec3 sunlight{1.0F};  // irradiance on a plane facing the sun
  glm::vec3 ambient{0.0F};   // mean radiance from sky and ground
  glm::vec3 from_sky{0.0F};  // mean radiance of the upper and of the lower half
  glm::vec3 from_ground{0.0F};
};

struct RenderSettings {
  scene::Rendering rendering;
  scene::View view;
  Illumination illumination;
  glm::ivec2 eye_size{1};  // of the eye buffer in pixels
  int slices = 128;        // or samples along a ray
  // How far the ground is along each pixel's ray; none where nothing hides a part of the medium.
  const gl::Texture2D* ground_distance = nullptr;
};

}  // namespace thunderhead::renderers
