#include "physics/sky.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace thunderhead::physics {

namespace {

// Maximum eye height for the sky table. An eye above this height sees the atmosphere as from this
// height.
constexpr float kHighestEye_m = 0.98F * kAtmosphereTop_m;

// Returns the sine of the elevation in the middle of a table row. It is the inverse of
// glsl::sky_cell.
float SineOfRow(int row, float horizon_sine) {
  constexpr int kMiddle = glsl::kSkyElevations / 2;
  if (row >= kMiddle) {
    const float root = static_cast<float>(row - kMiddle) / (kMiddle - 1);
    return horizon_sine + root * root * (1.0F - horizon_sine);
  }
  const float root = static_cast<float>(kMiddle - 1 - row) / (kMiddle - 1);
  // The result is slightly below the horizon, because exactly on the horizon the ray would miss the
  // ground.
  return horizon_sine - std::max(root * root, 1e-5F) * (1.0F + horizon_sine);
}

}  // namespace

ClearSky::ClearSky(const Atmosphere& atmosphere, const glm::vec3& towards_sun, const Site& site)
    : towards_sun_(towards_sun),
      sun_transmittance_(atmosphere.SunTransmittance(
          {glm::clamp(site.ground_m, 0.0F, kHighestEye_m), towards_sun.z})) {
  const float ground_m = glm::clamp(site.ground_m, 0.0F, kHighestEye_m);
  const float height_m = glm::clamp(site.eye_m, ground_m, kHighestEye_m);
  horizon_sine_ = physics::HorizonSine(height_m, ground_m);
  const float sun_across = std::sqrt(std::max(1.0F - towards_sun.z * towards_sun.z, 0.0F));
  table_.resize(static_cast<std::size_t>(2 * glsl::kSkyAzimuths * glsl::kSkyElevations));
  for (int y = 0; y < glsl::kSkyElevations; ++y) {
    const float sine = glm::clamp(SineOfRow(y, horizon_sine_), -1.0F, 1.0F);
    const float cosine = std::sqrt(1.0F - sine * sine);
    const Atmosphere::Line line =
        atmosphere.Along({.height_m = height_m, .ground_m = ground_m, .sine = sine});
    for (int x = 0; x < glsl::kSkyAzimuths; ++x) {
      const float east = 1.0F - 2.0F * static_cast<float>(x) / (glsl::kSkyAzimuths - 1);
      const float mu = cosine * east * sun_across + sine * towards_sun.z;
      const Atmosphere::Gathered gathered = atmosphere.Gather(line, {towards_sun.z, mu});
      const auto at = static_cast<std::size_t>(y * 2 * glsl::kSkyAzimuths + x);
      table_[at] =
          glm::vec4(gathered.air * glsl::air_phase(mu) + gathered.diffuse, line.air_mass.x);
      table_[at + glsl::kSkyAzimuths] = glm::vec4(gathered.haze, line.air_mass.y);
    }
  }
}

ClearSky::Seen ClearSky::At(const glm::vec3& direction) const {
  const glm::vec2 cell = glsl::sky_cell(direction, towards_sun_, horizon_sine_);
  const glm::ivec2 low =
      glm::min(glm::ivec2(cell), glm::ivec2(glsl::kSkyAzimuths, glsl::kSkyElevations) - 2);
  const glm::vec2 share = cell - glm::vec2(low);
  const auto at = [this](int x, int y) {
    return table_[static_cast<std::size_t>(y * 2 * glsl::kSkyAzimuths + x)];
  };
  const auto half = [&](int x) {
    return glm::mix(glm::mix(at(x, low.y), at(x + 1, low.y), share.x),
                    glm::mix(at(x, low.y + 1), at(x + 1, low.y + 1), share.x), share.y);
  };
  const glm::vec4 air = half(low.x);
  const glm::vec4 haze = half(low.x + glsl::kSkyAzimuths);
  const float phase = glsl::haze_phase(glm::dot(direction, towards_sun_));
  return {glm::vec3(air) + glm::vec3(haze) * phase, {air.a, haze.a}};
}

SkyLight ClearSky::Light() const {
  // Cells of equal size in the sine of the elevation and in the azimuth have equal solid angles, so
  // all samples have the same weight.
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
      const glm::vec3 radiance = At(direction).radiance;
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
