// The surroundings of a medium: sun, sky, ground, and the air in front of distant objects. Plain
// values and functions; knows no scene. Radiance and irradiance are per colour, in any consistent
// unit.
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
  glm::dvec3 albedo{0.0};  // Lambertian
  double water = 0.0;      // the share of it that is rough water in place of that (physics/water.h)
};

// Infinite Lambertian ground: a horizontal plane, or one that falls by d^2 curvature / 2 at a
// distance d from `touch_m`. Seen from above only.
struct Ground {
  double height_m = 0.0;     // at that place
  glm::dvec3 albedo{0.0};    // for light that arrives through the medium
  glm::dvec3 radiance{0.0};  // emitted upwards in addition
  glm::dvec2 touch_m{0.0};   // that place
  double curvature_per_m = 0.0;
  // For rays from the eye; `albedo` if not set.
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
  glm::dvec3 of_sky{0.0};        // of light that air has scattered before
  glm::dvec3 per_radiance{0.0};  // of even light of radiance 1 from everywhere
};

// The air that the medium shades.
struct ShadedAir {
  std::vector<Box> boxes;  // air outside all of them counts as lit
  std::function<AirLight(const Ray& ray, double distance_m)> light;
};

// A light besides the sun. It lights the medium only, and only the medium shades it.
struct DirectionalLight {
  glm::dvec3 towards{0.0, 0.0, 1.0};
  glm::dvec3 irradiance{0.0};  // on a plane facing it
};

// The sun as an eye sees it directly. Its light comes from one direction everywhere else.
struct SunDisc {
  double cosine = 1.0;       // of its angular radius
  glm::dvec3 radiance{0.0};  // evenly bright
};

struct Surroundings {
  glm::dvec3 towards_sun{0.0, 0.0, 1.0};
  glm::dvec3 sun_irradiance{0.0};  // on a plane facing the sun; all from one direction
  // The same at heights of 0, kSunStep_m ... above sea level, linear between; empty: the same
  // everywhere.
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
  // Radiance that comes from a direction; black if not set.
  std::function<glm::dvec3(const glm::dvec3& direction)> sky;
  // The sky as seen from the eye; `sky` if not set.
  std::function<glm::dvec3(const glm::dvec3& direction)> seen_sky;
  // Black if not set.
  std::optional<SunDisc> disc;
  std::optional<Ground> ground;
  // Air between the eye and the ground or the medium; clear if not set. The sky needs none: its
  // light is the air's.
  std::function<Air(const Ray& ray, double distance_m, Behind behind)> air;
  // Takes the medium's shadow from the light of that air and of the seen sky; lit if not set.
  std::optional<ShadedAir> shaded_air;
};

}  // namespace thunderhead::reference
