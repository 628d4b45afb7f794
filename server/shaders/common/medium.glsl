// The extinction of a medium's groups at a point. Each group is a channel: groups 0-3 are the channels of plane 0,
// groups 4-7 those of plane 1. Unused channels of a plane must have the weight zero.
//
// GROUPS is the number of groups. DETAILS is the number of noise textures that add turbulent detail
// (physics/detail.glsl). The first noise also displaces the medium. Each noise multiplies a given share of each channel
// (`detail_shares`). With DETAILS 0 the code for noises is not compiled.
//
// Uniforms needed in a loop are read before the loop. Inside a loop, some invocations may already have ended. Mesa's
// software renderer then reads a uniform once for every invocation (gallivm 22.3).
#include "common/bindings.glsl"
#include "common/medium_box.glsl"
#include "physics/detail.glsl"

#ifndef DETAILS
#error "DETAILS is not defined"
#endif
#define PLANES ((GROUPS + 3) / 4)

layout(binding = kMediumPlaneUnit) uniform sampler3D medium_plane_0;
#if PLANES > 1
layout(binding = kMediumPlaneUnit + 1) uniform sampler3D medium_plane_1;
#endif

uniform vec4 extinction_weights[PLANES];  // factors from a texel to extinction in 1/m; zero for unused channels

#if DETAILS > 0
layout(binding = kDetailNoiseUnit) uniform sampler3D detail_noise[DETAILS];
layout(binding = kDetailControlUnit) uniform sampler3D detail_control;  // one texel a cell, like the medium
uniform vec3 detail_tile_size[DETAILS];  // size of a tile in the medium's texture coordinates
uniform vec3 detail_tile_corner[DETAILS];  // corner of a tile, which drifts with the wind
uniform mat3 detail_fibres;  // transformation from tiles of billows to tiles of fibres
uniform vec3 detail_warp;  // full displacement in the medium's texture coordinates
uniform vec4 detail_shares[DETAILS * PLANES];  // share of each channel that noise multiplies
uniform float detail_left_out[DETAILS];  // share of the noise that is missing from its texture because it is too fine
// Share of the remaining noise that is faded out at a distance of 0 from the eye.
uniform float detail_fade_at_start[DETAILS];
uniform float detail_fade_per_m[DETAILS];  // increase of the faded share per metre of distance

vec3 tiles_scale[DETAILS];
vec3 tiles_offset[DETAILS];
#endif

// Prepares the noises' coordinates. Call it before the other functions.
void begin_medium() {
#if DETAILS > 0
  for (int i = 0; i < DETAILS; ++i) {
    tiles_scale[i] = 1.0 / detail_tile_size[i];
    tiles_offset[i] = -detail_tile_corner[i] * tiles_scale[i];
  }
#endif
}

struct Medium {
  vec4 plane[PLANES];
};

// Returns the texel values at `place`, which is in texture coordinates and `distance_m` from the eye.
Medium medium_at_place(vec3 place, float distance_m) {
#if DETAILS > 0
  // An amplitude of 0 is stored as 128 of 255.
  vec4 here = texture(detail_control, place);
  vec2 control = here.rg * vec2(1.0, 255.0 / 127.0) - vec2(0.0, 128.0 / 127.0);
  float column_factor = detail_column_factor(here.b);
  vec4 noise[DETAILS];
  float faded[DETAILS];
  for (int i = 0; i < DETAILS; ++i) {
    vec3 tile = place * tiles_scale[i] + tiles_offset[i];
    tile = control.y < 0.0 ? detail_fibres * tile : tile;
    float fade = clamp(detail_fade_at_start[i] + detail_fade_per_m[i] * distance_m, 0.0, 1.0);
    noise[i] = mix(texture(detail_noise[i], tile), vec4(0.5), fade);
    faded[i] = max(detail_left_out[i], fade);
  }
  place += detail_warp_share(here.a, control.y) * detail_warp * (noise[0].gba * 2.0 - 1.0);
#endif
  Medium medium;
  medium.plane[0] = texture(medium_plane_0, place);
#if PLANES > 1
  medium.plane[1] = texture(medium_plane_1, place);
#endif
#if DETAILS > 0
  for (int plane = 0; plane < PLANES; ++plane) medium.plane[plane] *= column_factor;
  for (int i = 0; i < DETAILS; ++i) {
    float change = detail_factor(control, noise[i].r, faded[i]) - 1.0;
    for (int plane = 0; plane < PLANES; ++plane) {
      medium.plane[plane] *= 1.0 + change * detail_shares[i * PLANES + plane];
    }
  }
#endif
  return medium;
}

Medium mixed(Medium a, Medium b, float at) {
  for (int plane = 0; plane < PLANES; ++plane) a.plane[plane] = mix(a.plane[plane], b.plane[plane], at);
  return a;
}

// Returns the sum over all groups of weight times texel value.
float weigh(Medium medium, vec4 weights[PLANES]) {
  float sum = dot(medium.plane[0], weights[0]);
#if PLANES > 1
  sum += dot(medium.plane[1], weights[1]);
#endif
  return sum;
}

// Returns `weights` times `factor`. Computing them before a loop avoids reading uniforms in the loop.
vec4[PLANES] scaled(vec4 weights[PLANES], float factor) {
  for (int plane = 0; plane < PLANES; ++plane) weights[plane] *= factor;
  return weights;
}
