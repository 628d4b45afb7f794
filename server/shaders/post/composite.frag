// The linear frame: what the eye buffer holds in front of sky and ground.
#include "physics/sky.glsl"

layout(binding = 4) uniform sampler2D eye;

uniform vec3 ray_forward;
uniform vec3 ray_right;  // scaled to the half width of the picture
uniform vec3 ray_up;
uniform vec3 towards_sun;
uniform float sky_scale;        // irradiance times brightness
uniform vec3 ground_radiance;
uniform float eye_height_m;     // above the ground

in vec2 position;
out vec4 linear_rgb;

// The air between the eye and the ground fades it into the horizon: depth per metre at sea level.
const float kScaleHeight_m = 8000.0;

void main() {
  vec3 ray = normalize(ray_forward + position.x * ray_right + position.y * ray_up);
  vec3 background = sky_scale * sky_radiance(vec3(ray.xy, abs(ray.z)), towards_sun);
  if (ray.z < 0.0 && eye_height_m > 0.0) {
    float distance_m = min(eye_height_m / -ray.z, 4e5);
    // The path's mean air: it climbs from the ground to the eye.
    float air_m = distance_m * kScaleHeight_m / eye_height_m * (1.0 - exp(-eye_height_m / kScaleHeight_m));
    vec3 depth = (air_optical_depth() + haze_optical_depth()) * (air_m / kScaleHeight_m);
    vec3 horizon = sky_scale * sky_radiance(normalize(vec3(ray.xy, 0.0)), towards_sun);
    background = mix(horizon, ground_radiance, exp(-depth));
  }
  vec4 front = texture(eye, 0.5 * position + 0.5);
  linear_rgb = vec4(front.rgb + front.a * background, 1.0);
}
