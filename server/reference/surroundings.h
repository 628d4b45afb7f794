// Where light comes from around a medium: sun, sky, ground, and the air in front of a distant
// ground. Plain values and functions; knows no scene. Radiance and irradiance are per colour, in
// any one unit.
#pragma once

#include <functional>
#include <optional>

#include "glm/vec3.hpp"
#include "reference/brick_walk.h"

namespace thunderhead::reference {

// A level, endless Lambertian plane. Seen from above only.
struct Ground {
  double height_m = 0.0;
  glm::dvec3 albedo{0.0};    // reflects what reaches it, through the medium's shadows
  glm::dvec3 radiance{0.0};  // sent up besides
};

// What air does to the ground behind it.
struct Air {
  glm::dvec3 transmittance{1.0};
  glm::dvec3 airlight{0.0};
};

struct Surroundings {
  glm::dvec3 towards_sun{0.0, 0.0, 1.0};
  glm::dvec3 sun_irradiance{0.0};  // on a plane facing the sun; all from one direction
  // Radiance that comes from a direction; black if not set.
  std::function<glm::dvec3(const glm::dvec3& direction)> sky;
  std::optional<Ground> ground;
  // Air between the eye and the ground; clear if not set. Only what the eye sees of the ground
  // passes through it.
  std::function<Air(const Ray& ray, double ground_distance_m)> air;
};

}  // namespace thunderhead::reference
