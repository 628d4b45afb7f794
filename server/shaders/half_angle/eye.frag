// The eye buffer after a slab of consecutive slices: radiance scattered towards the eye (rgb) and the share of what lies
// behind that passes (a). Goes through the points at which the ray meets the slices, in the order in which sunlight does, and leaps over
// those in empty bricks. Riley et al. 2003 (Vis), eq. 5 with the phase of eq. 18; the light comes from carry.comp.
// Variants: GROUND (what lies behind it is left out), GROUPS, COLORED (per-group colours), EVEN_ALBEDO (one albedo and
// colour for all), TRANSLUCENT, CONSISTENT (transport), FRONT_TO_BACK (the eye is on the sun's side).
#include "common/medium.glsl"
#include "common/bricks.glsl"
#include "common/phase.glsl"
#include "common/view.glsl"
#define GLOWS CONSISTENT
#include "common/scattered.glsl"
#include "physics/light_transport.glsl"

// What enters each slice of the slab, a layer a slice. r: share of sunlight, g: optical depth towards the sun.
layout(binding = 4) uniform sampler2DArray light;
layout(binding = 5) uniform sampler2D thickness;  // r: optical depth along the whole sun ray

layout(binding = 6) uniform sampler2D eye;  // before the slab
#if GROUND
layout(binding = 7) uniform sampler2D ground_distance;
#endif
uniform vec3 towards_sun;
uniform vec3 slice_normal;    // to the sun's side
uniform float first_plane_m;  // distance of the first slice's plane from the middle of the box, along the normal
uniform float spacing_m;
uniform float light_path_m;   // length of a sun ray between two slices
uniform float slab_begin;     // slices of the slab: from this
uniform float slab_end;       // to before this
uniform float begin_layer;    // of the light
uniform float layer_count;
uniform vec4 eye_weights[PLANES];        // texel to the extinction that the eye sees, 1/m
uniform vec4 light_weights[PLANES];      // texel to the extinction that the light buffer sees, 1/m
uniform vec4 transport_weights[PLANES];  // texel to similarity-scaled extinction, 1/m
uniform vec3 light_u;                // light buffer axes, scaled to its texture coordinates
uniform vec3 light_v;

in vec2 position;
out vec4 radiance_and_transmittance;

// Share of the background below which a ray ends.
const float kOpaque = 2e-3;

void main() {
  begin_medium();
  vec4 before = texelFetch(eye, ivec2(gl_FragCoord.xy), 0);
  vec3 direction = ray_direction(position);
  vec3 origin_m = ray_origin(position);
  vec3 safe = safe_direction(direction);
  vec2 way = way_in_medium(origin_m, safe, 0.0);
  way.x = max(way.x, 0.0);
#if GROUND
  way.y = min(way.y, texelFetch(ground_distance, ivec2(gl_FragCoord.xy), 0).r);
#endif
#if !FRONT_TO_BACK
  // Sunlight meets the slices from behind: from here on ways are counted towards the eye.
  safe = -safe;
  way = -way.yx;
#endif
  MediumRay ray = medium_ray(origin_m, safe);
  vec2 light_start = vec2(dot(origin_m, light_u), dot(origin_m, light_v)) + 0.5;
  vec2 light_step = vec2(dot(safe, light_u), dot(safe, light_v));

  // The ray meets slice i, counted from 0, where its way is first_m + i * apart_m.
  float falling = -dot(safe, slice_normal);
  float per_falling = 1.0 / max(falling, 1e-4);
  float apart_m = spacing_m * per_falling;
  float first_m = (dot(origin_m, slice_normal) - first_plane_m) * per_falling;
  float per_apart = 1.0 / apart_m;
  float slice = max(slab_begin, ceil((way.x - first_m) * per_apart));
  float end = min(slab_end, floor((way.y - first_m) * per_apart) + 1.0);

  // A ray along the slices would have no end; the limit is where perspective's corners lie in the widest view.
  float path_m = spacing_m / max(falling, 0.05);
  vec4 eye_depths[PLANES] = scaled(eye_weights, path_m);
  vec4 light_depths[PLANES] = scaled(light_weights, light_path_m);
  vec4 transport_depths[PLANES] = scaled(transport_weights, light_path_m);
  vec4 extinction_depths[PLANES] = scaled(extinction_weights, path_m);
  float layer_of_first = begin_layer - slab_begin;
  float layers = layer_count;

  Scattered scattered = nothing_scattered();
#if FRONT_TO_BACK
  float passing = before.a;
  if (passing < kOpaque) end = 0.0;
#else
  float passing = 1.0;
#endif
  while (slice < end) {
    float way_m = first_m + slice * apart_m;
    while (slice < end) {
      vec3 brick = brick_place(ray, way_m);
      uint content = brick_content(ray, brick);
      if (content == kThickBrick || content == kThinBrick) break;
      slice = max(slice + 1.0, ceil((way_m + empty_way(ray, brick, content) - first_m) * per_apart));
      way_m = first_m + slice * apart_m;
    }
    float counts = slice < end ? 1.0 : 0.0;
    Medium medium = medium_at_place(medium_place(ray, way_m));
    float depth = counts * weigh(medium, eye_depths);
    float layer = layer_of_first + slice;
    layer -= layer < layers ? 0.0 : layers;
    vec2 light_place = light_start + way_m * light_step;
    vec2 arrived = texture(light, vec3(light_place, layer)).rg;
    float passed = exp(-depth);
    float seen = mean_transmittance(depth);

#if FRONT_TO_BACK
    float shows = passing * counts;
#else
    fade(scattered, passed);
    float shows = counts;
#endif
#if CONSISTENT
    // The buffer holds the light that enters the slice; on its way through, light fades as the view does.
    float light_depth = weigh(medium, light_depths);
    float lit_and_seen = FRONT_TO_BACK == 1 ? mean_transmittance(depth + light_depth)
                                            : mean_counter_transmittance(depth, light_depth);
    add_direct(scattered, medium, shows * arrived.r * lit_and_seen);
    float mean_intensity = 0.0;
#if TRANSLUCENT
    float total = texture(thickness, light_place).r;
    float slice_depth = weigh(medium, transport_depths);
    // Diffuse light that leaves a cloud comes from one transport mean free path (2/3 by Eddington) inside it.
    float within = FRONT_TO_BACK == 1 ? mean_seen_place(depth) : 1.0 - mean_seen_place(depth);
    float tau = min(arrived.g + within * slice_depth + 2.0 / 3.0, total);
    mean_intensity = diffuse_mean_intensity(tau, total);
#endif
    add_isotropic(scattered, medium, extinction_depths, shows * (depth * seen), mean_intensity);
#else
    add_direct(scattered, medium, shows * arrived.r * seen);
#endif
    passing *= passed;
    slice += 1.0;
#if FRONT_TO_BACK
    if (passing < kOpaque) end = 0.0;
#endif
  }
  float turned = haversine_between(direction, towards_sun);
#if FRONT_TO_BACK
  radiance_and_transmittance = vec4(before.rgb + radiance_of(scattered, path_m, turned, before.a - passing), passing);
#else
  vec3 radiance = radiance_of(scattered, path_m, turned, 1.0 - passing);
  radiance_and_transmittance = vec4(radiance + passing * before.rgb, passing * before.a);
#endif
}
