// The clear sky as the eye sees it, from its table. Below the horizon, it is the light of the air in front of the
// ground.
#include "common/bindings.glsl"
#include "physics/sky.glsl"

layout(binding = kSkyTableUnit) uniform sampler2D sky_table;

uniform float horizon_sine;  // sine of the elevation of the horizon

struct Sky {
  vec3 radiance;  // in units of the sun's irradiance above the atmosphere
  vec2 air_mass;  // air masses of air and haze along the whole ray
};

// Returns the sky in the direction of the unit vector `direction` (z up).
Sky sky_at(vec3 direction, vec3 towards_sun) {
  vec2 size = vec2(2 * kSkyAzimuths, kSkyElevations);
  vec2 cell = sky_cell(direction, towards_sun, horizon_sine) + 0.5;
  vec4 air = texture(sky_table, cell / size);
  vec4 haze = texture(sky_table, (cell + vec2(kSkyAzimuths, 0.0)) / size);
  return Sky(air.rgb + haze.rgb * haze_phase(dot(direction, towards_sun)), vec2(air.a, haze.a));
}
