// Adds the sun's disc to the linear frame, behind the eye buffer's content. Variants: RELIEF, CHOSEN.
#include "common/bindings.glsl"
#include "common/ground.glsl"
#include "common/ray_place.glsl"
#include "common/view.glsl"
#include "sun/disc.glsl"

layout(binding = kEyeUnit) uniform sampler2D eye;

uniform vec3 towards_sun;
uniform vec3 sunlight;  // irradiance at the eye

out vec4 added;

void main() {
  begin_place();
  vec3 ray = ray_direction(position);
  vec3 apart = ray - towards_sun;
  float disc = disc_radiance(angle_of(0.25 * dot(apart, apart)));
  bool hidden = ground_distance_m(ray_origin(position), ray) > 0.0;
  vec3 radiance = sunlight * (disc * at_pixel(eye).a);
  added = vec4(hidden ? vec3(0.0) : min(radiance, vec3(kMaxRadiance)), 0.0);
}
