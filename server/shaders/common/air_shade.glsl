// Light that the storm's shadow takes from the air between the eye and a distance on a ray (air/shade.comp).
#include "common/bindings.glsl"

layout(binding = kAirShadeUnit) uniform sampler3D air_shade;

uniform float shade_near_m;
uniform float shade_far_m;

// `place` as common/view.glsl has it.
vec3 air_shade_before(vec2 place, float distance_m) {
  float layers = float(textureSize(air_shade, 0).z);
  float along = clamp((distance_m - shade_near_m) / (shade_far_m - shade_near_m), 0.0, 1.0);
  return texture(air_shade, vec3(0.5 * place + 0.5, (along * (layers - 1.0) + 0.5) / layers)).rgb;
}
