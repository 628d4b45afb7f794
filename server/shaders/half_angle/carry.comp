// Propagates sunlight through consecutive slices of the light buffer. Each layer holds the light that enters a slice: r
// is the share of sunlight, g the similarity-scaled optical depth from the sun. Neighbouring texels exchange light once
// in each dispatch. With CONSISTENT, they exchange the light that was scattered since the last dispatch. With the
// paper's transport, they exchange the light scattered in the only slice of the dispatch. Variants: GROUPS, DETAILS,
// CONSISTENT, TRANSLUCENT (texels exchange light).
#include "common/bindings.glsl"
#include "common/medium.glsl"
#include "common/bricks.glsl"
#include "half_angle/bindings.glsl"
#include "half_angle/slice_light.glsl"

layout(local_size_x = kLightGroupSide, local_size_y = kLightGroupSide) in;
#define EXCHANGES (TRANSLUCENT && CONSISTENT)
layout(binding = kLeavingLightImage) uniform writeonly image2DArray leaving;
#if EXCHANGES
// Optical depth of scattering into the outer ring of directions since the last exchange.
layout(binding = kRingDepthImage, r32f) uniform image2D ring_depth;
#endif

layout(binding = kSliceLightUnit) uniform sampler2DArray light;

uniform ivec2 first_texel;
uniform ivec2 end_texel;
uniform int first_slice;
uniform int slice_count;
uniform int first_layer;
uniform vec4 light_weights[PLANES];
uniform vec4 transport_weights[PLANES];
uniform vec4 peripheral_weights[PLANES];  // factors from a texel to scattering into the outer ring in 1/m
uniform vec2 cumulative_phase;            // CP(theta_f / 4), CP(theta_f / 2)
uniform vec2 tap_offset;  // offset of the samples in the ring, in texture coordinates

float peripheral(vec3 place) {
  float sum = texture(light, place + vec3(tap_offset.x, 0.0, 0.0)).r;
  sum += texture(light, place - vec3(tap_offset.x, 0.0, 0.0)).r;
  sum += texture(light, place + vec3(0.0, tap_offset.y, 0.0)).r;
  sum += texture(light, place - vec3(0.0, tap_offset.y, 0.0)).r;
  return 0.25 * sum;
}

// Returns the light after a slice of the medium. `here` is the light before it. `place` is in the light buffer.
vec2 carried(vec2 here, vec3 place, Medium medium, vec4 light_depths[PLANES], vec4 transport_depths[PLANES]) {
  float transmittance = exp(-weigh(medium, light_depths));
#if TRANSLUCENT && !CONSISTENT
  // Riley et al. 2003 (Vis), eq. 14 to 17 as printed.
  float blocked = 1.0 - transmittance;
  return vec2(here.r * (transmittance + blocked * cumulative_phase.x) +
                  peripheral(place) * blocked * (cumulative_phase.y - cumulative_phase.x),
              here.g);
#elif TRANSLUCENT
  return vec2(here.r * transmittance, here.g + weigh(medium, transport_depths));
#else
  return vec2(here.r * transmittance, here.g);
#endif
}

void main() {
  begin_medium();
  ivec2 texel = first_texel + ivec2(gl_GlobalInvocationID.xy);
  ivec3 size = textureSize(light, 0);
  vec2 place = (vec2(texel) + 0.5) / vec2(size.xy);
  SunRay ray = sun_ray(place);
  vec4 light_depths[PLANES] = scaled(light_weights, light_path_m);
  vec4 transport_depths[PLANES] = scaled(transport_weights, light_path_m);
#if EXCHANGES
  vec4 peripheral_depths[PLANES] = scaled(peripheral_weights, light_path_m);
#endif
  float path_m = light_path_m;
  int layer = first_layer;
  int end = any(greaterThanEqual(texel, end_texel)) ? 0 : slice_count;
  float distance_m = ray.first_m + float(first_slice) * path_m;
  vec2 here = texelFetch(light, ivec3(texel, layer), 0).rg;
#if EXCHANGES
  // The offset of the exchange is fixed, and the exchanged share grows with the path. The spread is therefore a
  // diffusion that does not depend on the number of slices.
  float ring = end > 0 ? imageLoad(ring_depth, texel).r : 0.0;
  if (ring > 0.0) {
    here.r = mix(here.r, peripheral(vec3(place, float(layer))), 1.0 - exp(-ring));
    ring = 0.0;
  }
#endif
  for (int i = 0; i < end; ++i) {
    uint content = brick_content(ray.medium, brick_place(ray.medium, distance_m));
    bool meets = distance_m >= ray.inside.x && distance_m <= ray.inside.y && is_filled(content);
    if (meets) {
      Medium medium = medium_at_place(medium_place(ray.medium, distance_m), 0.0);
      here = carried(here, vec3(place, float(layer)), medium, light_depths, transport_depths);
#if EXCHANGES
      ring += weigh(medium, peripheral_depths);
#endif
    }
    layer = layer + 1 < size.z ? layer + 1 : 0;
    imageStore(leaving, ivec3(texel, layer), vec4(here, 0.0, 0.0));
    distance_m += path_m;
  }
#if EXCHANGES
  if (end > 0) imageStore(ring_depth, texel, vec4(ring, 0.0, 0.0, 0.0));
#endif
}
