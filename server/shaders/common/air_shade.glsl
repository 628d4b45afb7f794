// Light that the storm's shadow takes from the air between the eye and a distance on a ray (air/shade.comp).
#include "common/bindings.glsl"

layout(binding = kAirShadeUnit) uniform sampler3D air_shade;

uniform float shade_near_m;
uniform float shade_far_m;

const float kThickeningHeight_m = 2000.0;  // over which air and haze together thicken by e

// `place` as common/view.glsl has it, `sine` that of the ray's elevation. Between two layers the air thickens or thins
// with height: straight lines between them would show as bands on the ground.
vec3 air_shade_before(vec2 place, float sine, float distance_m) {
  float last = float(textureSize(air_shade, 0).z - 1);
  float layer = clamp((distance_m - shade_near_m) / (shade_far_m - shade_near_m), 0.0, 1.0) * last;
  float thickening = clamp(-sine * (shade_far_m - shade_near_m) / (last * kThickeningHeight_m), -8.0, 8.0);
  float within = fract(layer);
  if (abs(thickening) > 0.01) within = (exp(thickening * within) - 1.0) / (exp(thickening) - 1.0);
  return texture(air_shade, vec3(0.5 * place + 0.5, (floor(layer) + within + 0.5) / (last + 1.0))).rgb;
}
