// The extinction of a medium's groups at a point. A group is a channel: 0-3 of plane 0, 4-7 of plane 1; channels that a
// plane does not have must be weighted with zero. GROUPS is the number of groups, DETAILS that of the turbulent noises
// that multiply shares of them (physics/turbulence.h); without any there is no code for them.
#ifndef DETAILS
#error "DETAILS is not defined"
#endif
#define PLANES ((GROUPS + 3) / 4)

layout(binding = 0) uniform sampler3D medium_plane_0;
#if PLANES > 1
layout(binding = 1) uniform sampler3D medium_plane_1;
#endif

uniform vec3 texture_from_local_scale;
uniform vec3 texture_from_local_offset;
uniform vec3 medium_low_m;   // the box, in local metres
uniform vec3 medium_high_m;

uniform vec4 extinction_weights[PLANES];  // texel to extinction, 1/m; zero for channels that no group has

#if DETAILS > 0
layout(binding = 8) uniform sampler3D detail_noise[DETAILS];
uniform vec3 detail_from_texture_scale[DETAILS];   // tiles from the medium's texture coordinates: at rest in the world
uniform vec3 detail_from_texture_offset[DETAILS];
uniform float detail_value_of_full[DETAILS];       // of the noise, whose root is fetched, where a texel is 1
uniform vec4 detail_shares[DETAILS * PLANES];      // of each channel that noise multiplies
#endif

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
    vec3 tiles = place * detail_from_texture_scale[i] + detail_from_texture_offset[i];
    float root = texture(detail_noise[i], tiles).r;
    float above_mean = root * root * detail_value_of_full[i] - 1.0;
    for (int plane = 0; plane < PLANES; ++plane) {
      medium.plane[plane] *= 1.0 + detail_shares[i * PLANES + plane] * above_mean;
    }
  }
#endif
  return medium;
}

// Texel values at `local_m`.
Medium medium_at(vec3 local_m) {
  return medium_at_place(local_m * texture_from_local_scale + texture_from_local_offset);
}

bool inside_medium(vec3 local_m) {
  return all(greaterThanEqual(local_m, medium_low_m)) && all(lessThanEqual(local_m, medium_high_m));
}

// The sum over groups of weight times value.
float weigh(Medium medium, vec4 weights[PLANES]) {
  float sum = dot(medium.plane[0], weights[0]);
#if PLANES > 1
  sum += dot(medium.plane[1], weights[1]);
#endif
  return sum;
}

// All groups' extinction, 1/m.
float total_extinction(Medium medium) { return weigh(medium, extinction_weights); }
