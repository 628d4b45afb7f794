// The sun's irradiance by height on a plane that faces the sun. It is attenuated by the air above, and zero in the
// Earth's shadow.
#include "common/bindings.glsl"

// Irradiance at heights above sea level that begin at 0 and are kSunlightStep_m apart.
uniform vec3 sunlight_levels[kSunlightLevels];
uniform float middle_height_m;  // height above sea level of the coordinates' origin

vec3 sunlight_at(float z_m) {
  float level = clamp((z_m + middle_height_m) / kSunlightStep_m, 0.0, float(kSunlightLevels - 1));
  int below = min(int(level), kSunlightLevels - 2);
  return mix(sunlight_levels[below], sunlight_levels[below + 1], level - float(below));
}
