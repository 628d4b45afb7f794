// Rays through a medium that leap over its empty bricks (volume/brick_map.h). Needs common/medium.glsl.
#include "common/box.glsl"

layout(binding = 2) uniform usampler3D bricks;  // volume::BrickMap::content

uniform vec3 brick_from_local_scale;
uniform vec3 brick_from_local_offset;
uniform ivec3 brick_count;

const uint kThickBrick = 0u;
const uint kThinBrick = 255u;

// A ray in the coordinates of the medium's texture and of its bricks: where it starts, and what a metre adds.
struct MediumRay {
  vec3 start;
  vec3 step;
  vec3 brick_start;
  vec3 brick_step;
  vec3 per_brick_step;
  vec3 highest_brick;
};

// `direction` is safe.
MediumRay medium_ray(vec3 origin_m, vec3 direction) {
  MediumRay ray;
  ray.start = origin_m * texture_from_local_scale + texture_from_local_offset;
  ray.step = direction * texture_from_local_scale;
  ray.brick_start = origin_m * brick_from_local_scale + brick_from_local_offset;
  ray.brick_step = direction * brick_from_local_scale;
  ray.per_brick_step = 1.0 / ray.brick_step;
  ray.highest_brick = vec3(brick_count) - 0.5;
  return ray;
}

// The part of the ray that is in the medium's box with `margin_m` around; x > y where it misses it. `direction` is safe.
vec2 way_in_medium(vec3 origin_m, vec3 direction, float margin_m) {
  return way_through_box(medium_low_m - margin_m, medium_high_m + margin_m, origin_m, direction);
}

vec3 medium_place(MediumRay ray, float way_m) { return ray.start + way_m * ray.step; }

vec3 brick_place(MediumRay ray, float way_m) { return ray.brick_start + way_m * ray.brick_step; }

// The brick at a place; beyond the box the nearest one.
ivec3 brick_at(MediumRay ray, vec3 place) { return ivec3(clamp(place, vec3(0.0), ray.highest_brick)); }

// What is in it.
uint brick_content(MediumRay ray, vec3 place) { return texelFetch(bricks, brick_at(ray, place), 0).r; }

// True where there is something in the brick.
bool is_filled(uint content) { return content == kThickBrick || content == kThinBrick; }

// How far along the ray from `place`, in bricks, the cube of empty bricks reaches that `content` tells of; with 1 the way to
// the end of the brick itself.
float empty_way(MediumRay ray, vec3 place, uint content) {
  vec3 across = abs(ray.per_brick_step);  // the way through a brick
  vec3 way = (vec3(brick_at(ray, place)) + 0.5 - place) * ray.per_brick_step + (float(content) - 0.5) * across;
  float beyond = 1e-3 * min(across.x, min(across.y, across.z));
  return min(way.x, min(way.y, way.z)) + beyond;
}
