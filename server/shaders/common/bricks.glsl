// Rays through a medium that skip the medium's empty bricks, which are empty blocks of cells (volume/brick_map.h).
#include "common/bindings.glsl"
#include "common/box.glsl"
#include "common/medium_box.glsl"

layout(binding = kBricksUnit) uniform usampler3D bricks;  // content as in volume::BrickMap::content

uniform vec3 brick_from_local_scale;
uniform vec3 brick_from_local_offset;
uniform ivec3 brick_count;

const uint kThickBrick = 0u;
const uint kThinBrick = 255u;

// A ray in the coordinates of the medium's texture and of its bricks: its start, and the change per metre.
struct MediumRay {
  vec3 start;
  vec3 step;
  vec3 brick_start;
  vec3 brick_step;
  vec3 per_brick_step;
  vec3 highest_brick;
  vec3 per_brick;  // size of a brick in texture coordinates
};

// Returns the ray. `direction` must come from safe_direction.
MediumRay medium_ray(vec3 origin_m, vec3 direction) {
  MediumRay ray;
  ray.start = origin_m * texture_from_local_scale + texture_from_local_offset;
  ray.step = direction * texture_from_local_scale;
  ray.brick_start = origin_m * brick_from_local_scale + brick_from_local_offset;
  ray.brick_step = direction * brick_from_local_scale;
  ray.per_brick_step = 1.0 / ray.brick_step;
  ray.highest_brick = vec3(brick_count) - 0.5;
  ray.per_brick = 1.0 / vec3(brick_count);
  return ray;
}

// Returns the part of the ray that is in the medium's box extended by `margin_m`. If the ray misses the box, x > y.
// `direction` must come from safe_direction.
vec2 path_in_medium(vec3 origin_m, vec3 direction, float margin_m) {
  return path_through_box(medium_low_m - margin_m, medium_high_m + margin_m, origin_m, direction);
}

vec3 medium_place(MediumRay ray, float distance_m) { return ray.start + distance_m * ray.step; }

vec3 brick_place(MediumRay ray, float distance_m) { return ray.brick_start + distance_m * ray.brick_step; }

// Returns the middle of the brick at a place. For a place outside all bricks, it returns the middle of the nearest
// brick.
vec3 brick_middle(MediumRay ray, vec3 place) { return floor(clamp(place, vec3(0.0), ray.highest_brick)) + 0.5; }

// Returns the content of the brick at a place. It uses texture(), because texelFetch takes twice as long in software
// GL.
uint brick_content(MediumRay ray, vec3 place) { return texture(bricks, brick_middle(ray, place) * ray.per_brick).r; }

// Returns true if the brick is not empty.
bool is_filled(uint content) { return content == kThickBrick || content == kThinBrick; }

// Returns the distance along the ray from `place` (in bricks) to the end of the cube of empty
// bricks around it. The brick's content `content` is the distance, in bricks, to the nearest brick
// that is not empty. If it is 1, the cube is the brick itself. A small margin is added, so that the
// ray leaves the cube.
float empty_path(MediumRay ray, vec3 place, uint content) {
  vec3 across = abs(ray.per_brick_step);  // path length through a brick along each axis
  vec3 path = (brick_middle(ray, place) - place) * ray.per_brick_step + (float(content) - 0.5) * across;
  float beyond = 1e-3 * min(across.x, min(across.y, across.z));
  return min(path.x, min(path.y, path.z)) + beyond;
}
