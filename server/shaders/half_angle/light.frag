// Carries sunlight through one slice of the light buffer: r is the share of sunlight, g the similarity-scaled optical
// depth passed. Variants: GROUPS, CONSISTENT, and PASS: 0 carries translucent light from `light`; 1 gives the slice's
// transmittance for a multiplying blend (low albedo); 2 gives its scaled optical depth for an adding blend (thickness).
#include "common/medium.glsl"

layout(binding = 4) uniform sampler2D light;

uniform vec3 slice_normal;
uniform float slice_distance_m;  // of the slice's plane from the middle of the box, along the normal
uniform float light_path_m;
uniform vec3 towards_sun;
uniform vec3 light_origin_m;  // of the buffer's middle, and metres across its half width and height
uniform vec3 light_right_m;
uniform vec3 light_up_m;
uniform vec4 light_weights[PLANES];
uniform vec4 transport_weights[PLANES];
uniform vec4 peripheral_weights[PLANES];  // scattering into the outer ring, 1/m
uniform vec2 cumulative_phase;            // CP(theta_f / 4), CP(theta_f / 2)
uniform vec2 tap_offset;                  // of a peripheral tap, in texture coordinates

in vec2 position;
out vec2 carried;

// Where this texel's sun ray meets the slice.
vec3 slice_point() {
  vec3 base = light_origin_m + position.x * light_right_m + position.y * light_up_m;
  float along = (slice_distance_m - dot(slice_normal, base)) / dot(slice_normal, towards_sun);
  return base + along * towards_sun;
}

vec2 peripheral(vec2 place) {
  vec2 sum = texture(light, place + vec2(tap_offset.x, 0.0)).rg;
  sum += texture(light, place - vec2(tap_offset.x, 0.0)).rg;
  sum += texture(light, place + vec2(0.0, tap_offset.y)).rg;
  sum += texture(light, place - vec2(0.0, tap_offset.y)).rg;
  return 0.25 * sum;
}

void main() {
  begin_medium();
  vec3 local_m = slice_point();
  Medium medium = medium_at(local_m);
  float inside = inside_medium(local_m) ? 1.0 : 0.0;
  float depth = inside * weigh(medium, light_weights) * light_path_m;
  float transport_depth = inside * weigh(medium, transport_weights) * light_path_m;
#if PASS == 1
  carried = vec2(exp(-depth), 1.0);
#elif PASS == 2
  carried = vec2(transport_depth, 0.0);
#else
  vec2 place = 0.5 * position + 0.5;
  vec2 centre = texture(light, place).rg;
  carried = centre;
  if (depth > 0.0) {
#if CONSISTENT
    // Peripheral light comes in as it is scattered into the ring; a fixed offset and a share that grows with the path
    // make the spread a diffusion, whatever the number of slices.
    float share = 1.0 - exp(-weigh(medium, peripheral_weights) * light_path_m);
    carried.r = exp(-depth) * mix(centre.r, peripheral(place).r, share);
    carried.g = centre.g + transport_depth;
#else
    // Riley et al. 2003 (Vis), eq. 14 to 17 as printed.
    float passed = exp(-depth);
    float blocked = 1.0 - passed;
    carried.r = centre.r * (passed + blocked * cumulative_phase.x) +
                peripheral(place).r * blocked * (cumulative_phase.y - cumulative_phase.x);
#endif
  }
#endif
}
