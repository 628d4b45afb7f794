#include "scene/shaded_air.h"

#include <algorithm>

#include "glm/common.hpp"
#include "glm/vec2.hpp"

namespace thunderhead::scene {
namespace {

// Margin around the storm for air under a partly hidden sky. At this distance, a storm 12 km high
// takes 7 % (20 km wide) to 11 % (much wider) of a uniform sky's light from level ground.
constexpr double kSkyMargin_m = 1.5e4;
// Maximum length of the storm's shadow. The shadow of a low sun is longer, but its far end lies in
// air that hardly affects the picture.
constexpr double kLongestShadow_m = 1.5e5;
// The boxes end this far below the lowest ground, because at a distance of 200 km the round Earth
// lies that far below the plane of world coordinates.
constexpr double kFallOfGround_m = 2700.0;

}  // namespace

ShadedAir ShadedAirOf(const volume::WorldBox& storm, const glm::dvec3& towards_sun,
                      double ground_m) {
  const double low_m = std::min(ground_m, storm.low_m.z);
  const glm::dvec2 along = towards_sun;
  const double height_m = storm.high_m.z - low_m;
  const double length_m = std::min(height_m / std::max(towards_sun.z, 1e-3), kLongestShadow_m);
  const glm::dvec3 shift_m(-along * length_m, 0.0);
  ShadedAir air{storm, storm};
  air.from_sun.low_m = glm::min(storm.low_m, storm.low_m + shift_m);
  air.from_sun.high_m = glm::max(storm.high_m, storm.high_m + shift_m);
  air.from_sky.low_m -= glm::dvec3(kSkyMargin_m, kSkyMargin_m, 0.0);
  air.from_sky.high_m += glm::dvec3(kSkyMargin_m, kSkyMargin_m, 0.0);
  air.from_sun.low_m.z = air.from_sky.low_m.z = low_m - kFallOfGround_m;
  return air;
}

}  // namespace thunderhead::scene
