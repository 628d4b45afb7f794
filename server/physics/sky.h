// The clear sky seen from a height above the ground, and its light. The sky is a table for one
// direction of the sun. shaders/physics/sky.glsl reads the table, and is compiled for the CPU here.
// Radiance is in units of the sun's irradiance above the atmosphere. The air between eye and storm
// is in shaders/physics/air.glsl.
#pragma once

#include <vector>

#include "glm/common.hpp"
#include "glm/exponential.hpp"
#include "glm/geometric.hpp"
#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "glm/vec4.hpp"
#include "physics/atmosphere.h"

namespace thunderhead::physics {
namespace glsl {

using glm::abs;
using glm::clamp;
using glm::dot;
using glm::exp;
using glm::max;
using glm::min;
using glm::sqrt;
using glm::vec2;
using glm::vec3;
#include "shaders/physics/air.glsl"
#include "shaders/physics/sky.glsl"
// air_light.glsl uses both files above, so it comes last.
#include "shaders/physics/air_light.glsl"

}  // namespace glsl

// Light from the whole sky, in units of the sun's irradiance above the atmosphere.
struct SkyLight {
  glm::vec3 mean_radiance{0.0F};  // mean over the upper hemisphere
  glm::vec3 irradiance{0.0F};     // irradiance on level ground
};

class ClearSky {
 public:
  // Heights are above sea level. `towards_sun` is a unit vector, z up.
  struct Site {
    float eye_m = 0.0F;
    float ground_m = 0.0F;
  };
  ClearSky(const Atmosphere& atmosphere, const glm::vec3& towards_sun, const Site& site);

  // The sky in one direction. Below the horizon, its radiance is that of the air in front of the
  // ground.
  struct Seen {
    glm::vec3 radiance{0.0F};
    glm::vec2 air_mass{0.0F};  // air masses of air and haze, as in Atmosphere::Line
  };
  // `direction` is a unit vector.
  Seen At(const glm::vec3& direction) const;

  // Rotates the sky to the azimuth of `towards_sun`. The sun's elevation stays unchanged.
  void TurnTo(const glm::vec3& towards_sun) {
    towards_sun_ = {towards_sun.x, towards_sun.y, towards_sun_.z};
  }

  // Integrates the radiance over the upper hemisphere.
  SkyLight Light() const;

  // Returns the transmittance from the ground to the sun.
  const glm::vec3& SunTransmittance() const { return sun_transmittance_; }

  // Returns 2 * kSkyAzimuths by kSkyElevations texels, with rows from the nadir up. The left half
  // holds the light scattered once by air or more than once, and the air mass of air. The right
  // half holds the light scattered once by haze, without phase function, and the air mass of haze.
  const std::vector<glm::vec4>& Table() const { return table_; }

 private:
  glm::vec3 towards_sun_;
  glm::vec3 sun_transmittance_;
  float horizon_sine_;
  std::vector<glm::vec4> table_;
};

}  // namespace thunderhead::physics
