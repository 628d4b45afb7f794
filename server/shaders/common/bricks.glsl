// Leaps over empty bricks of the medium (volume/brick_map.h). Needs common/medium.glsl.
layout(binding = 2) uniform usampler3D bricks;  // volume::BrickMap::content

uniform vec3 brick_from_local_scale;
uniform vec3 brick_from_local_offset;
uniform ivec3 brick_count;

const uint kThickBrick = 0u;
const uint kThinBrick = 255u;

// What is in the brick at `brick_place` (in bricks); beyond the box what is in the nearest one.
uint brick_content(vec3 brick_place) {
  return texelFetch(bricks, clamp(ivec3(floor(brick_place)), ivec3(0), brick_count - 1), 0).r;
}

// How far along a ray from `brick_place` the cube of empty bricks reaches that `content` tells of. `per_step` is the
// reciprocal of the ray's direction in bricks per unit.
float empty_way(vec3 brick_place, uint content, vec3 per_step) {
  vec3 middle = clamp(floor(brick_place), vec3(0.0), vec3(brick_count - 1)) + 0.5;
  vec3 way = (middle - brick_place + (float(content) - 0.5) * sign(per_step)) * per_step;
  float beyond = 1e-3 * min(abs(per_step.x), min(abs(per_step.y), abs(per_step.z)));
  return min(way.x, min(way.y, way.z)) + beyond;
}
