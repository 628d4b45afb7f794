// The share of the air's light on a ray that the storm's shadow removes (air/shade.comp). `place` is in the coordinates
// of common/view.glsl.
#include "common/bindings.glsl"

layout(binding = kAirShadeUnit) uniform sampler3D air_shade;

uniform float shade_near_m;
uniform float shade_far_m;

vec3 air_shade_at(vec2 place, float layer) {
  return texture(air_shade, vec3(0.5 * place + 0.5, (layer + 0.5) / float(textureSize(air_shade, 0).z))).rgb;
}

// Returns the removed share of airlight_before up to a distance. No light is removed beyond `shade_far_m`. For larger
// distances, the function therefore returns the share up to `shade_far_m`.
vec3 air_shade_before(vec2 place, float distance_m) {
  float last = float(textureSize(air_shade, 0).z - 2);
  return air_shade_at(place, clamp((distance_m - shade_near_m) / (shade_far_m - shade_near_m), 0.0, 1.0) * last);
}

// Returns the removed share of the whole sky's airlight.
vec3 air_shade_of_sky(vec2 place) { return air_shade_at(place, float(textureSize(air_shade, 0).z - 1)); }
