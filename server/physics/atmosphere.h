// Clear air around a round Earth: its transmittance for sunlight, and its radiance including all
// orders of scattering. The components are air (Rayleigh scattering), haze (optical depth from
// turbidity) and ozone (absorption only). Light scattered more than once counts as isotropic, as if
// all the air around a point were as bright as the air at that point. The orders of scattering then
// form a geometric series (Hillaire 2020, A scalable and production ready sky and atmosphere
// rendering technique, 5.5).
#pragma once

#include <vector>

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"

namespace thunderhead::physics {

// The effective radius of the Earth, which accounts for refraction. Straight rays above a sphere of
// this radius rise as refracted rays do above the Earth. It is 7/6 of the mean radius, from the
// surveyors' coefficient of refraction (1/7) for visible light. Radar uses 4/3, because water
// vapour refracts microwaves more.
constexpr double kEffectiveEarthRadius_m = 7.0 / 6.0 * 6.371e6;
constexpr float kEarthRadius_m = static_cast<float>(kEffectiveEarthRadius_m);
constexpr float kAtmosphereTop_m = 8e4F;

// Angular radius of the sun's disc.
constexpr double kSunRadius_rad = 0.00465;

// Coefficients of the atmosphere at one height, in 1/m.
struct AirOptics {
  glm::vec3 air{0.0F};   // scattering coefficient of air
  glm::vec3 haze{0.0F};  // scattering coefficient of haze
  glm::vec3 extinction{0.0F};
};

// The properties of a point in the atmosphere on which its light depends.
struct AirPlace {
  float height_m = 0.0F;
  float sun_sine = 0.0F;  // sine of the sun's elevation at the point
};

// Returns the sine of the elevation of the horizon. Rays from `height_m` with a lower elevation
// meet the ground at height `ground_m`. Both heights are above sea level.
float HorizonSine(float height_m, float ground_m = 0.0F);

// The position of a height between two rows of a table: the lower row, and the weight of the upper
// row.
struct TableRow {
  int low = 0;
  float share = 0.0F;
};

// The horizon and the table rows of a height, which are computed once for many lookups of the light
// that arrives there.
struct AirLevel {
  float horizon_sine = 0.0F;
  TableRow columns;  // rows in the table of the air columns from a height to space
  TableRow diffuse;
};

class Atmosphere {
 public:
  Atmosphere(float turbidity, float ground_albedo);

  AirOptics At(float height_m) const;

  // Returns the transmittance from the point to the sun. While the sun's disc sets, it falls
  // gradually to zero.
  glm::vec3 SunTransmittance(const AirPlace& place) const;

  // Returns the mean radiance, over all directions, of light that the air scattered or the ground
  // reflected at least once. The sun has the irradiance 1.
  glm::vec3 DiffuseMeanRadiance(const AirPlace& place) const;

  struct Ray {
    float height_m = 0.0F;
    float ground_m = 0.0F;  // height of the ground, at most the height of the ray
    float sine = 1.0F;      // sine of the elevation at the start
    int steps = 24;
  };
  // The air along a ray, independent of the sun's position.
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
    // Air masses of air and haze: their amounts along the ray, relative to the amounts in a
    // vertical column from sea level.
    glm::vec2 air_mass{0.0F};
    float end_m = 0.0F;
    float end_height_m = 0.0F;
    bool meets_ground = false;
  };
  Line Along(const Ray& ray) const;

  // The sun's direction at the start of a ray.
  struct Sunwards {
    float sine = 1.0F;  // sine of the sun's elevation
    float mu = 1.0F;    // cosine of the sun's angle to the ray
  };
  // Light scattered towards the start of a ray.
  struct Gathered {
    glm::vec3 air{0.0F};      // light scattered once by air, without phase function
    glm::vec3 haze{0.0F};     // light scattered once by haze, without phase function
    glm::vec3 diffuse{0.0F};  // light scattered after an earlier scattering or reflection
  };
  Gathered Gather(const Line& line, const Sunwards& sun) const;

 private:
  glm::vec3 SunTransmittance(const AirLevel& level, float sun_sine) const;
  glm::vec3 DiffuseMeanRadiance(const TableRow& row, float sun_sine) const;
  glm::vec3 SumOrders(const AirPlace& place, float ground_albedo) const;

  glm::vec3 haze_depth_;
  std::vector<glm::vec3> diffuse_;  // table by height, then by the sine of the sun's elevation
};

}  // namespace thunderhead::physics
