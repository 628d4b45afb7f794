// The extinction of a medium's groups at a point. A group is a channel: 0-3 of plane 0, 4-7 of plane 1; channels that a
// plane does not have must be weighted with zero. GROUPS is the number of groups, DETAILS that of the turbulent noises
// that multiply shares of them (physics/turbulence.h); without any there is no code for them.
// Uniforms that a loop needs are read before it: inside, where some invocations may have ended, Mesa's software renderer
// reads a uniform once for every invocation (gallivm 22.3).
#include "common/bindings.glsl"

#ifndef DETAILS
#error "DETAILS is not defined"
#endif
#define PLANES ((GROUPS + 3) / 4)

layout(binding = kMediumPlaneUnit) uniform sampler3D medium_plane_0;
#if PLANES > 1
layout(binding = kMediumPlaneUnit + 1) uniform sampler3D medium_plane_1;
#endif

uniform vec3 texture_from_local_scale;
uniform vec3 texture_from_local_offset;
uniform vec3 medium_low_m;   // the box, in local metres
uniform vec3 medium_high_m;

uniform vec4 extinction_weights[PLANES];  // texel to extinction, 1/m; zero for channels that no group has

#if DETAILS > 0
layout(binding = kDetailNoiseUnit) uniform sampler3D detail_noise[DETAILS];
uniform vec3 detail_tile_size[DETAILS];    // of a tile in the medium's texture coordinates: at rest in the world
uniform vec3 detail_tile_corner[DETAILS];  // and where one begins
uniform float detail_value_of_full[DETAILS];       // of the noise (its root is fetched) where a texel is 1
uniform vec4 detail_shares[DETAILS * PLANES];      // of each channel that noise multiplies

vec3 tiles_scale[DETAILS];
vec3 tiles_offset[DETAILS];
vec4 detail_rest[DETAILS * PLANES];  // factor of each channel where the noise is zero
vec4 detail_gain[DETAILS * PLANES];  // and the slope with the square of what is fetched
#endif

// Call first.
void begin_medium() {
#if DETAILS > 0
  for (int i = 0; i < DETAILS; ++i) {
    tiles_scale[i] = 1.0 / detail_tile_size[i];
    tiles_offset[i] = -detail_tile_corner[i] * tiles_scale[i];
    for (int plane = 0; plane < PLANES; ++plane) {
      detail_rest[i * PLANES + plane] = 1.0 - detail_shares[i * PLANES + plane];
      detail_gain[i * PLANES + plane] = detail_value_of_full[i] * detail_shares[i * PLANES + plane];
    }
  }
#endif
}

struct Medium {
  vec4 plane[PLANES];
};

// Texel values at `place` in texture coordinates.
Medium medium_at_place(vec3 place) {
  Medium medium;
  medium.plane[0] = texture(medium_plane_0, place);
#if PLANES > 1
  medium.plane[1] = texture(medium_plane_1, place);
#endif
#if DETAILS > 0
  for (int i = 0; i < DETAILS; ++i) {
    float root = texture(detail_noise[i], place * tiles_scale[i] + tiles_offset[i]).r;
    for (int plane = 0; plane < PLANES; ++plane) {
      medium.plane[plane] *= detail_rest[i * PLANES + plane] + detail_gain[i * PLANES + plane] * (root * root);
    }
  }
#endif
  return medium;
}

Medium mixed(Medium a, Medium b, float at) {
  for (int plane = 0; plane < PLANES; ++plane) a.plane[plane] = mix(a.plane[plane], b.plane[plane], at);
  return a;
}

// The sum over groups of weight times value.
float weigh(Medium medium, vec4 weights[PLANES]) {
  float sum = dot(medium.plane[0], weights[0]);
#if PLANES > 1
  sum += dot(medium.plane[1], weights[1]);
#endif
  return sum;
}

// `weights` times `factor`, for a loop to use in their place.
vec4[PLANES] scaled(vec4 weights[PLANES], float factor) {
  for (int plane = 0; plane < PLANES; ++plane) weights[plane] *= factor;
  return weights;
}
