#include "physics/sky.h"

#include <cmath>
#include <numbers>

namespace thunderhead::physics {

SkyLight SkyLightOf(const glm::vec3& towards_sun) {
  // Midpoints in sine of elevation and azimuth divide the hemisphere into equal solid angles.
  constexpr int kElevations = 32;
  constexpr int kAzimuths = 64;
  SkyLight light;
  for (int i = 0; i < kElevations; ++i) {
    const float sine = (static_cast<float>(i) + 0.5F) / kElevations;
    const float cosine = std::sqrt(1.0F - sine * sine);
    for (int j = 0; j < kAzimuths; ++j) {
      const float azimuth =
          2.0F * std::numbers::pi_v<float> * (static_cast<float>(j) + 0.5F) / kAzimuths;
      const glm::vec3 direction(cosine * std::cos(azimuth), cosine * std::sin(azimuth), sine);
      const glm::vec3 radiance = glsl::sky_radiance(direction, towards_sun);
      light.mean_radiance += radiance;
      light.irradiance += radiance * sine;
    }
  }
  constexpr float kCount = kElevations * kAzimuths;
  light.mean_radiance /= kCount;
  light.irradiance *= 2.0F * std::numbers::pi_v<float> / kCount;
  return light;
}

}  // namespace thunderhead::physics
