// Clear air around a round Earth: its transmittance for sunlight, and its radiance by light
// scattered any number of times. Air (Rayleigh scattering), haze (optical depth from turbidity) and
// ozone (absorption only). Light scattered twice and more is taken as isotropic and as if the air
// were everywhere as bright as at the point, which sums all orders as a geometric series (Hillaire
// 2020, A scalable and production ready sky and atmosphere rendering technique, 5.5).
#pragma once

#include <vector>

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"

namespace thunderhead::physics {

// The radius of a sphere without refraction above which straight rays rise as real ones do above
// the Earth: 7/6 of the mean radius, the surveyors' coefficient of refraction (1/7) for visible
// light. Radar's 4/3 is for microwaves, which water vapour bends more.
constexpr double kEffectiveEarthRadius_m = 7.0 / 6.0 * 6.371e6;
constexpr float kEarthRadius_m = static_cast<float>(kEffectiveEarthRadius_m);
constexpr float kAtmosphereTop_m = 8e4F;

// Angular radius of the sun's disc.
constexpr double kSunRadius_rad = 0.00465;

// Coefficients of the atmosphere at some height, 1/m.
struct AirOptics {
  glm::vec3 air{0.0F};   // scattering
  glm::vec3 haze{0.0F};  // scattering
  glm::vec3 extinction{0.0F};
};

// A point in the atmosphere: only its height and the sun's elevation matter.
struct AirPlace {
  float height_m = 0.0F;
  float sun_sine = 0.0F;  // of the sun's elevation there
};

// Sine of the elevation of the horizon: rays from `height_m` that go lower meet the ground at
// `ground_m`. Both are above sea level.
float HorizonSine(float height_m, float ground_m = 0.0F);

// A height's place between two rows of a table: the lower row, and the weight of the upper one.
struct TableRow {
  int low = 0;
  float share = 0.0F;
};

// A height, prepared for looking up the light that arrives there.
struct AirLevel {
  float horizon_sine = 0.0F;
  TableRow columns;  // of air towards space
  TableRow diffuse;
};

class Atmosphere {
 public:
  Atmosphere(float turbidity, float ground_albedo);

  AirOptics At(float height_m) const;

  // Transmittance from the point to the sun; falls gradually to zero while the disc sets.
  glm::vec3 SunTransmittance(const AirPlace& place) const;

  // Mean radiance from all directions of light scattered at least once, for a sun of irradiance 1.
  glm::vec3 DiffuseMeanRadiance(const AirPlace& place) const;

  struct Ray {
    float height_m = 0.0F;
    float ground_m = 0.0F;  // height of the ground, not above the ray's
    float sine = 1.0F;      // of the elevation at the start
    int steps = 24;
  };
  // The air on a ray, wherever the sun is.
  struct Line {
    struct Step {
      float distance_m = 0.0F;
      float height_m = 0.0F;
      // Scattering coefficient integrated over the step, times the transmittance to the ray's
      // start.
      glm::vec3 air{0.0F};
      glm::vec3 haze{0.0F};
      AirLevel level;
    };
    float height_m = 0.0F;
    std::vector<Step> steps;
    glm::vec3 transmittance{1.0F};  // over the whole ray
    // Air masses of air and haze: amounts on the ray over those of a vertical column from sea
    // level.
    glm::vec2 air_mass{0.0F};
    float end_m = 0.0F;
    float end_height_m = 0.0F;
    bool meets_ground = false;
  };
  Line Along(const Ray& ray) const;

  // The sun, from the start of a ray.
  struct Sunwards {
    float sine = 1.0F;  // of its elevation
    float mu = 1.0F;    // cosine of its angle to the ray
  };
  // Light scattered towards the start of a ray.
  struct Gathered {
    glm::vec3 air{0.0F};      // once by air, without phase function
    glm::vec3 haze{0.0F};     // once by haze, without phase function
    glm::vec3 diffuse{0.0F};  // more than once
  };
  Gathered Gather(const Line& line, const Sunwards& sun) const;

 private:
  glm::vec3 SunTransmittance(const AirLevel& level, float sun_sine) const;
  glm::vec3 DiffuseMeanRadiance(const TableRow& row, float sun_sine) const;
  glm::vec3 SumOrders(const AirPlace& place, float ground_albedo) const;

  glm::vec3 haze_depth_;
  std::vector<glm::vec3> diffuse_;  // by height, then by the sine of the sun's elevation
};

}  // namespace thunderhead::physics
