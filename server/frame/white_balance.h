// The colour of a scene's light, which determines the white balance. The code consists of pure
// values and does not use GL.
#pragma once

#include <optional>

#include "glm/vec3.hpp"
#include "physics/atmosphere.h"
#include "scene/scene.h"

namespace thunderhead::frame {

// The light of a white card (reflectance 1) that faces the sun under the scene's sky.
struct WhiteCard {
  glm::vec3 radiance{1.0F};  // radiance of the card
  // Factors for each colour that make the card neutral and keep its luminance. If the sun is lower
  // than 10 degrees, the factors for a sun 10 degrees high are used, so that sunsets stay warm.
  glm::vec3 balance{1.0F};
};

// Weights of luminance in linear sRGB.
inline constexpr glm::vec3 kLuminance(0.2126F, 0.7152F, 0.0722F);
float LuminanceOf(const glm::vec3& rgb);

// Computes white cards and caches the values that depend only on sun and air.
class WhiteCards {
 public:
  const WhiteCard& Of(const scene::Scene& scene);

 private:
  // The inputs of the card's colour. The sun's azimuth only rotates the light and its irradiance
  // only scales it, so neither is an input.
  struct Key {
    double elevation_deg = 0.0;
    scene::Sky sky;

    bool operator==(const Key&) const = default;
  };

  void Find(const Key& key);

  std::optional<Key> key_;
  std::optional<physics::Atmosphere> atmosphere_;
  glm::vec3 radiance_{1.0F};  // radiance of the card for a sun of irradiance 1
  WhiteCard card_;
};

}  // namespace thunderhead::frame
