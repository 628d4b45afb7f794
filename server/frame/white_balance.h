// The colour of a scene's light: what makes a white card look white. Pure values; no GL.
#pragma once

#include <optional>

#include "glm/vec3.hpp"
#include "physics/atmosphere.h"
#include "scene/scene.h"

namespace thunderhead::frame {

// A white card (reflectance 1) that faces the sun under the scene's sky.
struct WhiteCard {
  glm::vec3 radiance{1.0F};  // that it sends
  // Factors for each colour that make it neutral and keep its luminance. Those of a sun 10 degrees
  // high for any lower one, so that sunsets stay warm.
  glm::vec3 balance{1.0F};
};

// Weights of luminance in linear sRGB.
inline constexpr glm::vec3 kLuminance(0.2126F, 0.7152F, 0.0722F);
float LuminanceOf(const glm::vec3& rgb);

// Keeps what depends on sun and air until they change.
class WhiteCards {
 public:
  const WhiteCard& Of(const scene::Scene& scene);

 private:
  // The sun's azimuth turns the light and its irradiance scales it; neither changes the colour.
  struct Key {
    double elevation_deg = 0.0;
    scene::Sky sky;

    bool operator==(const Key&) const = default;
  };

  void Find(const Key& key);

  std::optional<Key> key_;
  std::optional<physics::Atmosphere> atmosphere_;
  glm::vec3 radiance_{1.0F};  // for a sun of irradiance 1
  WhiteCard card_;
};

}  // namespace thunderhead::frame
