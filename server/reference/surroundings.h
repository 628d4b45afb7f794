// The surroundings of a medium: sun, sky, ground, and the air in front of distant objects. They are
// plain values and functions that do not use a scene. Radiance and irradiance are per colour, in
// any consistent unit.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "glm/common.hpp"
#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "reference/brick_walk.h"

namespace thunderhead::reference {

// A place of the ground as an eye sees it.
struct SeenGround {
  glm::dvec3 albedo{0.0};  // Lambertian albedo
  double water = 0.0;      // the share of rough water, which replaces the albedo (physics/water.h)
};

// Infinite Lambertian ground, seen only from above. It is a horizontal plane, or it falls by d^2
// curvature / 2 at a distance d from `touch_m`.
struct Ground {
  double height_m = 0.0;     // at `touch_m`
  glm::dvec3 albedo{0.0};    // for light that arrives through the medium
  glm::dvec3 radiance{0.0};  // radiance emitted upwards in addition
  glm::dvec2 touch_m{0.0};   // where the ground is horizontal
  double curvature_per_m = 0.0;
  // Ground for rays from the eye. If it is not set, they see `albedo`.
  std::function<SeenGround(const glm::dvec2& place_m)> seen;
};

struct Box {
  glm::dvec3 low_m{0.0};
  glm::dvec3 high_m{0.0};
};

// The kinds of background behind the air.
enum class Behind { kMedium, kGround };

// The effect of air on light from behind it.
struct Air {
  glm::dvec3 transmittance{1.0};
  glm::dvec3 airlight{0.0};
};

// Radiance that a metre of lit air on a ray adds to what its eye sees.
struct AirLight {
  glm::dvec3 of_sun{0.0};
  glm::dvec3 of_sky{0.0};        // light that air has scattered before
  glm::dvec3 per_radiance{0.0};  // for uniform light of radiance 1 from all directions
};

// The air that the medium shades.
struct ShadedAir {
  std::vector<Box> boxes;  // air outside all of them counts as lit
  std::function<AirLight(const Ray& ray, double distance_m)> light;
};

// A light in addition to the sun. It lights only the medium, and only the medium shades it.
struct DirectionalLight {
  glm::dvec3 towards{0.0, 0.0, 1.0};
  glm::dvec3 irradiance{0.0};  // on a plane facing the light
};

// The sun as an eye sees it directly. For everything else, its light comes from one direction.
struct SunDisc {
  double cosine = 1.0;       // cosine of its angular radius
  glm::dvec3 radiance{0.0};  // uniform over the disc
};

struct Surroundings {
  glm::dvec3 towards_sun{0.0, 0.0, 1.0};
  glm::dvec3 sun_irradiance{0.0};  // on a plane facing the sun; from a single direction
  // The sun's irradiance at heights of 0, kSunStep_m ... above sea level, linear in between. If it
  // is empty, the irradiance is the same everywhere.
  std::vector<glm::dvec3> sun_by_height{};
  static constexpr double kSunStep_m = 100.0;
  glm::dvec3 SunAt(double height_m) const {
    if (sun_by_height.empty()) return sun_irradiance;
    const double step =
        std::clamp(height_m / kSunStep_m, 0.0, static_cast<double>(sun_by_height.size() - 1));
    const auto below = std::min(static_cast<std::size_t>(step), sun_by_height.size() - 2);
    return glm::mix(sun_by_height[below], sun_by_height[below + 1],
                    step - static_cast<double>(below));
  }
  std::vector<DirectionalLight> lights;
  // Returns the radiance that arrives from a direction. Not set: black.
  std::function<glm::dvec3(const glm::dvec3& direction)> sky;
  // Returns the sky as seen from the eye. Not set: `sky`.
  std::function<glm::dvec3(const glm::dvec3& direction)> seen_sky;
  // Not set: black.
  std::optional<SunDisc> disc;
  std::optional<Ground> ground;
  // Returns the air between the eye and the ground or the medium. Not set: clear. The sky needs no
  // air, because its light is the air's light.
  std::function<Air(const Ray& ray, double distance_m, Behind behind)> air;
  // Subtracts the medium's shadow from the light of that air and of the seen sky. Not set: all air
  // is lit.
  std::optional<ShadedAir> shaded_air;
};

}  // namespace thunderhead::reference
