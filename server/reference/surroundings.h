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

// The reflectance of a place on the ground as an eye sees it.
struct SeenGround {
  glm::dvec3 albedo{0.0};  // Lambertian albedo
  // Share of the place that is rough water, which does not have this albedo (physics/water.h).
  double water = 0.0;
};

// Infinite Lambertian ground, seen only from above. It is a horizontal plane, or it lies d^2
// curvature_per_m / 2 below that plane at a distance d from `touch_m`.
struct Ground {
  double height_m = 0.0;   // height of the ground at `touch_m`
  glm::dvec3 albedo{0.0};  // albedo for light that arrives through the medium
  // Radiance that the ground emits upwards in addition to reflected light.
  glm::dvec3 radiance{0.0};
  glm::dvec2 touch_m{0.0};  // where the ground is horizontal
  double curvature_per_m = 0.0;
  // Reflectance of the ground for rays from the eye. If it is not set, these rays see `albedo`.
  std::function<SeenGround(const glm::dvec2& place_m)> seen;
};

struct Box {
  glm::dvec3 low_m{0.0};
  glm::dvec3 high_m{0.0};
};

// The object that the eye sees behind the air.
enum class Behind { kMedium, kGround };

// The effect of air on light from behind it.
struct Air {
  glm::dvec3 transmittance{1.0};
  glm::dvec3 airlight{0.0};
};

// Radiance that one metre of lit air on a ray adds to what the eye sees.
struct AirLight {
  glm::dvec3 of_sun{0.0};
  glm::dvec3 of_sky{0.0};        // part that was skylight before the air scattered it
  glm::dvec3 per_radiance{0.0};  // what light of radiance 1 from all directions would add
};

// The air in which the medium casts its shadow.
struct ShadedAir {
  std::vector<Box> boxes;  // air outside all boxes counts as lit
  std::function<AirLight(const Ray& ray, double distance_m)> light;
};

// A light in addition to the sun. It lights only the medium, and only the medium shades it.
struct DirectionalLight {
  glm::dvec3 towards{0.0, 0.0, 1.0};
  glm::dvec3 irradiance{0.0};  // irradiance on a plane that faces the light
};

// The sun's disc as an eye sees it directly. For all other purposes, sunlight comes from one
// direction.
struct SunDisc {
  double cosine = 1.0;       // cosine of the disc's angular radius
  glm::dvec3 radiance{0.0};  // uniform over the disc
};

struct Surroundings {
  glm::dvec3 towards_sun{0.0, 0.0, 1.0};
  // Irradiance of the sun on a plane facing it, from a single direction.
  glm::dvec3 sun_irradiance{0.0};
  // The sun's irradiance at heights above sea level that begin at 0 and are kSunStep_m apart,
  // linear in between. If it is empty, the irradiance is the same at all heights.
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
  // Returns the radiance that arrives from a direction. If it is not set, the sky is black.
  std::function<glm::dvec3(const glm::dvec3& direction)> sky;
  // Returns the sky's radiance as seen from the eye. If it is not set, `sky` is used.
  std::function<glm::dvec3(const glm::dvec3& direction)> seen_sky;
  // The sun's disc. If it is not set, the eye does not see a disc.
  std::optional<SunDisc> disc;
  std::optional<Ground> ground;
  // Returns the air between the eye and the ground or the medium. If it is not set, that air is
  // perfectly clear. The sky needs no air in front, because its light is the air's own light.
  std::function<Air(const Ray& ray, double distance_m, Behind behind)> air;
  // The air that the medium shades. The light that is missing there is subtracted from the light of
  // this air and of the seen sky. If it is not set, all air is lit.
  std::optional<ShadedAir> shaded_air;
};

}  // namespace thunderhead::reference
