// The second pass of P. Man's method ("Generating and Real-Time Rendering of Clouds", section 4.2). For each pixel, it
// composites the balls by eq. 29 from front to back until the pixel is opaque. Each tile of the picture has a list of
// the balls that may cover it, from front to back. The result equals blending the balls' splats from back to front, but
// the picture is not read and written for each ball. A ball's optical depth is the integral of its field along the ray,
// from the eye up to the ground.
//
// With DETAIL, noise at all scales that pixels resolve moves the balls' surfaces inwards. A place then shows the mean
// light of all balls there, weighted by their fields, so that single balls are not recognisable. Variants: GROUND (the
// parts of balls behind the ground are omitted), PAPER (the optical depth is the field's own value, so eq. 12 is
// splatted unchanged), DETAIL.
#include "common/bindings.glsl"
#include "common/ground_distance.glsl"
#include "common/view.glsl"
#include "metaball/balls.glsl"
#include "metaball/bindings.glsl"
#include "physics/light_transport.glsl"
#include "physics/wyvill.glsl"

// The index in `order` of each tile's first ball, row by row, and finally the length of `order`.
layout(std430, binding = kBallTilesBinding) readonly buffer TileStarts { uint tile_starts[]; };
// Radiance of the balls, from source.comp.
layout(std430, binding = kBallSourcesBinding) readonly buffer Sources { vec4 sources[]; };

uniform int tile_px;
uniform int tiles_across;
#if DETAIL
layout(binding = kDetailNoiseUnit) uniform sampler3D noise;  // physics/detail_tile.h
uniform float noise_per_m;  // tiles of noise per metre
uniform vec3 noise_offset;
uniform float roughness;     // 0 to 1
uniform float largest_radius_m;  // largest radius of a ball
#endif

in vec2 position;
layout(location = 0) out vec4 radiance_and_transmittance;
layout(location = 1) out float opacity_distance_m;  // opacity times the mean distance of what is visible

#if DETAIL
const float kRelief = 0.5;  // depth of the deepest valley, as a share of a ball's squared radius
const float kDisplaced = 0.5;  // displacement in radii
// At a roughness of 1, noise reduces a ball's optical depth, averaged over its disc, by a factor of
// about exp(-kEroded). The optical depth is multiplied by the reciprocal of this factor.
const float kEroded = 0.7;
const float kMinSeen = 0.01;  // a ball with a smaller share of a pixel shows its own light instead of the mean

// Returns 1 - (u / R)^2 for the ray that passes the ball's middle at the distance u, after the noise has eroded its
// surface.
float eroded(float s, vec3 origin_m, vec3 ray, vec3 across_m, float surface_m, float per_radius) {
  vec4 here = texture(noise, (origin_m + surface_m * ray) * noise_per_m + noise_offset);
  vec3 moved = across_m * per_radius + (roughness * kDisplaced) * (here.gba * 2.0 - 1.0);
  return min(s, 1.0 - dot(moved, moved)) - roughness * kRelief * (1.0 - here.r) * (1.0 - 0.7 * s);
}

// Returns the distance by which balls are sorted (renderers/metaball/tiles.cc).
float ordered_by_m(vec3 off_m, vec3 ray) { return ray_right == vec3(0.0) ? dot(off_m, ray) : length(off_m); }

// Adds the light of a ball at a place to the sum over balls, weighted by the ball's extinction there. Returns false if
// neither this ball nor any later ball in the order can contain the place, because its distance exceeds the largest
// radius.
bool add_light(uint index, vec3 origin_m, vec3 ray, float place_distance_m, inout vec4 sum) {
  vec4 middle_radius = balls[index].middle_radius;
  vec3 from_eye_m = middle_radius.xyz - origin_m;
  if (abs(ordered_by_m(from_eye_m, ray) - place_distance_m) > largest_radius_m) return false;
  vec3 off_m = (from_eye_m - place_distance_m * ray) / middle_radius.w;
  float w = 1.0 - dot(off_m, off_m);
  if (w <= 0.0) return true;
  vec4 source = sources[index];
  sum += source.a * wyvill_field(w) * vec4(source.rgb, 1.0);
  return true;
}

// Returns the mean light at a place on the ray. It is the mean over the balls from `first` to `end` of the tile's list,
// weighted by their extinctions at the place. The place is in ball `i` of the list.
vec3 light_at(vec3 origin_m, vec3 ray, float distance_m, uint i, uint first, uint end) {
  vec4 sum = vec4(0.0);
  uint at = i;
  while (at < end && add_light(order[at], origin_m, ray, distance_m, sum)) ++at;
  at = i;
  while (at > first && add_light(order[at - 1u], origin_m, ray, distance_m, sum)) --at;
  return sum.rgb / max(sum.a, 1e-30);
}
#endif

void main() {
  ivec2 tile = ivec2(gl_FragCoord.xy) / tile_px;
  int listed = tile.y * tiles_across + tile.x;
  uint first = tile_starts[listed];
  uint end = tile_starts[listed + 1];
  vec3 ray = ray_direction(position);
  vec3 origin_m = ray_origin(position);
#if GROUND
  float end_m = texelFetch(ground_distance, ivec2(gl_FragCoord.xy), 0).r;
#endif
  vec3 radiance = vec3(0.0);
  float transmittance = 1.0;
#if DETAIL
  float kept = exp(kEroded * roughness);
#endif
  float shown_m = 0.0;
  for (uint i = first; i < end && transmittance > kOpaqueTransmittance; ++i) {
    uint index = order[i];
    vec4 middle_radius = balls[index].middle_radius;
    vec3 off_m = middle_radius.xyz - origin_m;
    float along_m = dot(off_m, ray);
    // The component across the ray is computed first. The square of the whole vector would lose a small ball that is
    // far away by rounding.
    vec3 across_m = off_m - along_m * ray;
    float per_radius = 1.0 / middle_radius.w;
    float s = 1.0 - dot(across_m, across_m) * (per_radius * per_radius);
    if (s <= 0.0) continue;
    vec4 source = sources[index];
#if DETAIL
    float surface_m = along_m - sqrt(s) * middle_radius.w;
    s = eroded(s, origin_m, ray, across_m, surface_m, per_radius);
    if (s <= 0.0) continue;
#endif
    float half_chord = sqrt(s);
    float from = -along_m * per_radius;
    float to = half_chord;
#if GROUND
    to = min(to, (end_m - along_m) * per_radius);
#endif
    if (from >= to || to <= -half_chord) continue;
#if PAPER
    float depth = source.a * wyvill_field(s);
    float taken = depth;  // eq. 26
#else
    float column = from <= -half_chord && to >= half_chord
                       ? wyvill_column(s)
                       : wyvill_column_to(s, to) - wyvill_column_to(s, max(from, -half_chord));
    float depth = source.a * middle_radius.w * max(column, 0.0);
#if DETAIL
    depth *= kept;
#endif
    float taken = depth * mean_transmittance(depth);  // 1 - exp(-depth)
#endif
    vec3 light = source.rgb;
#if DETAIL
    if (transmittance * taken > kMinSeen) {
      // About half of the ball's visible light comes from in front of this place. Fields grow with
      // the square of the depth below the surface.
      float before = half_chord * min(pow(1.4 / max(depth, 1e-6), 1.0 / 3.0), 1.0);
      // The mean light counts only half. Deeper balls have more weight at this place, and they are darker than the
      // surface.
      light = 0.5 * (light + light_at(origin_m, ray, along_m + (before - half_chord) * middle_radius.w, i, first, end));
    }
#endif
    radiance += transmittance * taken * light;
    float ball_transmittance = exp(-depth);
    shown_m += transmittance * (1.0 - ball_transmittance) *
               max(along_m + 0.5 * (max(from, -half_chord) + to) * middle_radius.w, 0.0);
    transmittance *= ball_transmittance;
  }
  radiance_and_transmittance = vec4(radiance, transmittance);
  opacity_distance_m = shown_m;
}
