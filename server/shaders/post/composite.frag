// The linear frame: what the eye buffer holds in front of sky and ground.
#include "common/view.glsl"
#include "physics/sky.glsl"
#include "physics/air.glsl"

layout(binding = 4) uniform sampler2D eye;

uniform vec3 towards_sun;       // where the eye is, like the rays: east, north, up
uniform float sky_scale;        // irradiance times brightness
uniform vec3 ground_radiance;
uniform float eye_height_m;     // above the ground
uniform float ground_curvature_per_m;

in vec2 position;
out vec4 linear_rgb;

const float kFarthestGround_m = 4e5;

void main() {
  vec3 ray = ray_direction(position);
  vec3 background = sky_scale * sky_radiance(vec3(ray.xy, abs(ray.z)), towards_sun);
  float ground_m = level_ground_distance_m(eye_height_m, ray.z, ground_curvature_per_m);
  if (ground_m > 0.0) {
    // What the air takes of the ground's light it fills up with the horizon's.
    vec3 horizon = sky_scale * sky_radiance(normalize(vec3(ray.xy, 0.0) + vec3(1e-6, 0.0, 0.0)), towards_sun);
    background = mix(horizon, ground_radiance, air_transmittance(min(ground_m, kFarthestGround_m), eye_height_m));
  }
  vec4 front = texture(eye, 0.5 * position + 0.5);
  linear_rgb = vec4(front.rgb + front.a * background, 1.0);
}
