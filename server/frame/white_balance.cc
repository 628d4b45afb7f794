#include "frame/white_balance.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "glm/geometric.hpp"
#include "glm/trigonometric.hpp"
#include "physics/sky.h"

namespace thunderhead::frame {
namespace {

constexpr double kLowestBalanced_deg = 10.0;

// Returns the radiance of a white card for a sun of irradiance 1 above the atmosphere. The upper
// half of the hemisphere that the card faces counts as a uniform sky, the lower half as level
// ground.
glm::vec3 RadianceOfCard(const physics::Atmosphere& atmosphere, const scene::Sky& sky,
                         double elevation_deg) {
  constexpr float kInversePi = std::numbers::inv_pi_v<float>;
  const auto sine = static_cast<float>(std::sin(glm::radians(elevation_deg)));
  const glm::vec3 sun(std::sqrt(std::max(1.0F - sine * sine, 0.0F)), 0.0F, sine);
  const physics::ClearSky clear(atmosphere, sun, {0.0F, 0.0F});
  const physics::SkyLight light = clear.Light();
  const auto brightness = static_cast<float>(sky.brightness);
  const glm::vec3 level =
      brightness * light.irradiance + clear.SunTransmittance() * std::max(sine, 0.0F);
  const glm::vec3 from_ground = level * (static_cast<float>(sky.ground_albedo) * kInversePi);
  return clear.SunTransmittance() * kInversePi +
         brightness * light.mean_radiance * (0.5F + 0.5F * sine) +
         from_ground * (0.5F - 0.5F * sine);
}

}  // namespace

float LuminanceOf(const glm::vec3& rgb) { return glm::dot(rgb, kLuminance); }

const WhiteCard& WhiteCards::Of(const scene::Scene& scene) {
  const Key key{scene.sun.elevation_deg, scene.sky};
  if (key_ != key) Find(key);
  card_.radiance = radiance_ * static_cast<float>(scene.sun.irradiance);
  return card_;
}

void WhiteCards::Find(const Key& key) {
  if (!key_.has_value() || key_->sky.turbidity != key.sky.turbidity ||
      key_->sky.ground_albedo != key.sky.ground_albedo) {
    atmosphere_.emplace(static_cast<float>(key.sky.turbidity),
                        static_cast<float>(key.sky.ground_albedo));
  }
  radiance_ = RadianceOfCard(*atmosphere_, key.sky, key.elevation_deg);
  const glm::vec3 balanced = key.elevation_deg < kLowestBalanced_deg
                                 ? RadianceOfCard(*atmosphere_, key.sky, kLowestBalanced_deg)
                                 : radiance_;
  card_.balance = LuminanceOf(balanced) / glm::max(balanced, glm::vec3(1e-12F));
  key_ = key;
}

}  // namespace thunderhead::frame
