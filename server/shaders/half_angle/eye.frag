// Draws the eye buffer after a slab of consecutive slices: radiance scattered towards the eye (rgb) and transmittance
// for light from behind (a). It visits the points at which the ray meets the slices, in the order in which sunlight
// meets the slices. Points in empty bricks are skipped. The method is Riley et al. 2003 (Vis), eq. 5 with the phase of
// eq. 18. The light comes from carry.comp.
//
// Variants: GROUND, GROUPS, DETAILS, COLORED, EVEN_ALBEDO, TRANSLUCENT, CONSISTENT, ORDER. With GROUND the parts of the
// medium behind the ground are omitted. With COLORED groups have colours. With EVEN_ALBEDO all groups have the same
// albedo and no colours. CONSISTENT is consistent transport. ORDER is 1 if all rays meet the slices in the order of
// sunlight, and 0 if all meet them in the reverse order. It is 2 if a wide view has both kinds.
#include "common/medium.glsl"
#include "common/bricks.glsl"
#include "common/ground_distance.glsl"
#include "common/phase.glsl"
#include "common/sunlight.glsl"
#include "common/view.glsl"
#define GLOWS CONSISTENT
#include "common/scattered.glsl"
#include "half_angle/bindings.glsl"
#include "physics/light_transport.glsl"

// Light that enters each slice of the slab, with one layer for each slice. r is the share of
// sunlight, g the similarity-scaled optical depth towards the sun.
layout(binding = kSliceLightUnit) uniform sampler2DArray light;
// Channel r is the similarity-scaled optical depth along the whole sun ray.
layout(binding = kSliceThicknessUnit) uniform sampler2D thickness;

layout(binding = kEyeBeforeUnit) uniform sampler2D eye;  // eye buffer before this slab
layout(binding = kDistanceBeforeUnit) uniform sampler2D distance_before;
uniform vec3 towards_sun;
uniform vec3 slice_normal;  // points to the sun's side
uniform float first_plane_m;  // distance of the first slice's plane from the middle of the box, along the normal
uniform float spacing_m;
uniform float light_path_m;   // length of a sun ray between two slices
uniform float slab_begin;     // first slice of the slab
uniform float slab_end;  // index after the slab's last slice
uniform float begin_layer;  // layer of the light that enters the slab's first slice
uniform vec4 eye_weights[PLANES];  // factors from a texel to the extinction along the eye's ray in 1/m
uniform vec4 light_weights[PLANES];  // factors from a texel to the extinction in the light buffer in 1/m
uniform vec4 transport_weights[PLANES];  // factors from a texel to the similarity-scaled extinction in 1/m
uniform vec3 light_u;  // axes of the light buffer, scaled to its texture coordinates
uniform vec3 light_v;

in vec2 position;
layout(location = 0) out vec4 radiance_and_transmittance;
layout(location = 1) out float opacity_distance_m;  // opacity times the mean distance of what is visible

const float kEndTransmittance = 2e-3;  // a ray ends below this transmittance

void main() {
  begin_medium();
  vec4 before = texelFetch(eye, ivec2(gl_FragCoord.xy), 0);
  float before_m = texelFetch(distance_before, ivec2(gl_FragCoord.xy), 0).r;
  vec3 direction = ray_direction(position);
  vec3 origin_m = ray_origin(position);
  vec3 safe = safe_direction(direction);
  vec2 path = path_in_medium(origin_m, safe, 0.0);
  path.x = max(path.x, 0.0);
  path.y = until_ground(path.y);
  float climb = dot(safe, slice_normal);
#if ORDER == 2
  bool front_to_back = climb < 0.0;
#else
  const bool front_to_back = ORDER == 1;
#endif
  if (!front_to_back) {
    // Along this ray, the eye meets the slices in the reverse order of sunlight. From here on,
    // distances are therefore counted towards the eye, so that the slices are visited in the order
    // of sunlight.
    safe = -safe;
    path = -path.yx;
  }
  MediumRay ray = medium_ray(origin_m, safe);
  vec2 light_start = vec2(dot(origin_m, light_u), dot(origin_m, light_v)) + 0.5;
  vec2 light_step = vec2(dot(safe, light_u), dot(safe, light_v));

  // The ray meets slice i, counted from 0, at the distance first_m + i * apart_m.
  float falling = abs(climb);
  float per_falling = 1.0 / max(falling, 1e-4);
  float apart_m = spacing_m * per_falling;
  float first_m = (dot(origin_m, slice_normal) - first_plane_m) * per_falling;
  float per_apart = 1.0 / apart_m;
  float slice = max(slab_begin, ceil((path.x - first_m) * per_apart));
  float end = min(slab_end, floor((path.y - first_m) * per_apart) + 1.0);

  // The limit is needed for rays parallel to the slices, whose path through a slice would be infinite.
  float path_m = spacing_m / max(falling, 0.05);
  vec4 eye_depths[PLANES] = scaled(eye_weights, path_m);
  vec4 light_depths[PLANES] = scaled(light_weights, light_path_m);
  vec4 transport_depths[PLANES] = scaled(transport_weights, light_path_m);
  vec4 extinction_depths[PLANES] = scaled(extinction_weights, path_m);
  float layer_of_first = begin_layer - slab_begin;
  float layers = float(textureSize(light, 0).z);

  Scattered scattered = nothing_scattered();
  float shown_m = 0.0;
  float towards = front_to_back ? 1.0 : -1.0;
  float transmittance = front_to_back ? before.a : 1.0;
  if (front_to_back && transmittance < kEndTransmittance) end = 0.0;
  while (slice < end) {
    float distance_m = first_m + slice * apart_m;
    while (slice < end) {
      vec3 brick = brick_place(ray, distance_m);
      uint content = brick_content(ray, brick);
      if (is_filled(content)) break;
      slice = max(slice + 1.0, ceil((distance_m + empty_path(ray, brick, content) - first_m) * per_apart));
      distance_m = first_m + slice * apart_m;
    }
    float counts = slice < end ? 1.0 : 0.0;
    Medium medium = medium_at_place(medium_place(ray, distance_m), abs(distance_m));
    float depth = counts * weigh(medium, eye_depths);
    float layer = layer_of_first + slice;
    layer -= layer < layers ? 0.0 : layers;
    vec2 light_place = light_start + distance_m * light_step;
    vec2 arrived = texture(light, vec3(light_place, layer)).rg;
    float slice_transmittance = exp(-depth);
    float seen = mean_transmittance(depth);

    float shows = front_to_back ? transmittance * counts : counts;
    if (!front_to_back) {
      fade(scattered, slice_transmittance);
      shown_m *= slice_transmittance;
    }
    shown_m += shows * (1.0 - slice_transmittance) * (towards * distance_m);
#if CONSISTENT
    // The buffer holds the light that enters the slice. Inside the slice, both the light and the view are attenuated.
    float light_depth = weigh(medium, light_depths);
    float lit_and_seen = front_to_back ? mean_transmittance(depth + light_depth)
                                       : mean_counter_transmittance(depth, light_depth);
    add_direct(scattered, medium, shows * arrived.r * lit_and_seen);
    float mean_intensity = 0.0;
#if TRANSLUCENT
    float total = texture(thickness, light_place).r;
    float slice_depth = weigh(medium, transport_depths);
    // Diffuse light that leaves a cloud comes from one transport mean free path (2/3 by Eddington) below its surface.
    float within = front_to_back ? mean_seen_place(depth) : 1.0 - mean_seen_place(depth);
    float tau = min(arrived.g + within * slice_depth + 2.0 / 3.0, total);
    mean_intensity = diffuse_mean_intensity(tau, total);
#endif
    add_isotropic(scattered, medium, extinction_depths, shows * (depth * seen), mean_intensity);
#else
    add_direct(scattered, medium, shows * arrived.r * seen);
#endif
    transmittance *= slice_transmittance;
    slice += 1.0;
    if (front_to_back && transmittance < kEndTransmittance) end = 0.0;
  }
  // One height represents the sunlight. It is the mean height of everything visible in the slab on this ray.
  float opacity = max((front_to_back ? before.a : 1.0) - transmittance, 1e-30);
  vec3 sunlight = sunlight_at(origin_m.z + shown_m / opacity * direction.z);
  vec3 radiance = radiance_of(scattered, sunlight, path_m, haversine_between(direction, towards_sun));
  radiance_and_transmittance = front_to_back ? vec4(before.rgb + radiance, transmittance)
                                             : vec4(radiance + transmittance * before.rgb, transmittance * before.a);
  opacity_distance_m = front_to_back ? before_m + shown_m : shown_m + transmittance * before_m;
}
