#include "physics/sky.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace thunderhead::physics {

namespace {

// Above this, the atmosphere looks as from here.
constexpr float kHighestEye_m = 0.98F * kAtmosphereTop_m;

// The sine of elevation in the middle of a row: the inverse of glsl::sky_cell.
float SineOfRow(int row, float horizon_sine) {
  constexpr int kMiddle = glsl::kSkyElevations / 2;
  if (row >= kMiddle) {
    const float root = static_cast<float>(row - kMiddle) / (kMiddle - 1);
    return horizon_sine + root * root * (1.0F - horizon_sine);
  }
  const float root = static_cast<float>(kMiddle - 1 - row) / (kMiddle - 1);
  // Just below the horizon: on it the ray would miss the ground.
  return horizon_sine - std::max(root * root, 1e-5F) * (1.0F + horizon_sine);
}

}  // namespace

ClearSky::ClearSky(const Atmosphere& atmosphere, const glm::vec3& towards_sun, float eye_height_m)
    : towards_sun_(towards_sun),
      sun_transmittance_(atmosphere.SunTransmittance({0.0F, towards_sun.z})) {
  constexpr float kInverseFourPi = 0.25F * std::numbers::inv_pi_v<float>;
  const float height_m = glm::clamp(eye_height_m, 0.0F, kHighestEye_m);
  horizon_sine_ = physics::HorizonSine(height_m);
  const float sun_across = std::sqrt(std::max(1.0F - towards_sun.z * towards_sun.z, 0.0F));
  table_.resize(static_cast<std::size_t>(2 * glsl::kSkyAzimuths * glsl::kSkyElevations));
  for (int y = 0; y < glsl::kSkyElevations; ++y) {
    const float sine = glm::clamp(SineOfRow(y, horizon_sine_), -1.0F, 1.0F);
    const float cosine = std::sqrt(1.0F - sine * sine);
    for (int x = 0; x < glsl::kSkyAzimuths; ++x) {
      const float east = 1.0F - 2.0F * static_cast<float>(x) / (glsl::kSkyAzimuths - 1);
      Atmosphere::Ray ray;
      ray.height_m = height_m;
      ray.direction = {cosine * east, cosine * std::sqrt(std::max(1.0F - east * east, 0.0F)), sine};
      ray.towards_sun = {sun_across, 0.0F, towards_sun.z};
      const Atmosphere::Gathered gathered = atmosphere.Gather(ray, true);
      const float mu = glm::dot(ray.direction, ray.towards_sun);
      const float rayleigh = 0.75F * (1.0F + mu * mu) * kInverseFourPi;
      const auto at = static_cast<std::size_t>(y * 2 * glsl::kSkyAzimuths + x);
      table_[at] = glm::vec4(gathered.air * rayleigh + gathered.diffuse, 1.0F);
      table_[at + glsl::kSkyAzimuths] = glm::vec4(gathered.haze, 1.0F);
    }
  }
  light_ = Integrate();
}

glm::vec3 ClearSky::Radiance(const glm::vec3& direction) const {
  const glm::vec2 cell = glsl::sky_cell(direction, towards_sun_, horizon_sine_);
  const glm::ivec2 low =
      glm::min(glm::ivec2(cell), glm::ivec2(glsl::kSkyAzimuths, glsl::kSkyElevations) - 2);
  const glm::vec2 share = cell - glm::vec2(low);
  const auto at = [this](int x, int y) {
    return glm::vec3(table_[static_cast<std::size_t>(y * 2 * glsl::kSkyAzimuths + x)]);
  };
  const auto half = [&](int x) {
    return glm::mix(glm::mix(at(x, low.y), at(x + 1, low.y), share.x),
                    glm::mix(at(x, low.y + 1), at(x + 1, low.y + 1), share.x), share.y);
  };
  return half(low.x) +
         half(low.x + glsl::kSkyAzimuths) * glsl::haze_phase(glm::dot(direction, towards_sun_));
}

SkyLight ClearSky::Integrate() const {
  // Midpoints in sine of elevation and azimuth divide the hemisphere into equal solid angles.
  constexpr int kElevations = 24;
  constexpr int kAzimuths = 48;
  SkyLight light;
  for (int i = 0; i < kElevations; ++i) {
    const float sine = (static_cast<float>(i) + 0.5F) / kElevations;
    const float cosine = std::sqrt(1.0F - sine * sine);
    for (int j = 0; j < kAzimuths; ++j) {
      const float azimuth =
          2.0F * std::numbers::pi_v<float> * (static_cast<float>(j) + 0.5F) / kAzimuths;
      const glm::vec3 direction(cosine * std::cos(azimuth), cosine * std::sin(azimuth), sine);
      const glm::vec3 radiance = Radiance(direction);
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
