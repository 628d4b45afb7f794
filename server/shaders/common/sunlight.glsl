// The sun's irradiance by height on a plane that faces the sun. The air above attenuates it, and it is zero in the
// Earth's shadow.
#include "common/bindings.glsl"

uniform vec3 sunlight_levels[kSunlightLevels];  // at 0, kSunlightStep_m ... above sea level
uniform float middle_height_m;  // height above sea level of the coordinates' origin

vec3 sunlight_at(float z_m) {
  float level = clamp((z_m + middle_height_m) / kSunlightStep_m, 0.0, float(kSunlightLevels - 1));
  int below = min(int(level), kSunlightLevels - 2);
  return mix(sunlight_levels[below], sunlight_levels[below + 1], level - float(below));
}
