// The intersection of a view ray with the ground. Coordinates are in metres from an origin that the uniforms define,
// such as the middle of the medium's box. With RELIEF 0 the ground is level. With RELIEF 1 it is the terrain, whose
// edge values continue beyond the domain. The ground falls away from the point where the plane of world coordinates
// touches the Earth (scene/view.h). A curvature of 0 is a plane.
#include "common/bindings.glsl"

uniform float lowest_ground_m;
uniform float ground_curvature_per_m;
uniform vec2 touch_m;  // the point where the plane of world coordinates touches the Earth

const float kFarthestGround_m = 5e5;

// Returns the distance along a ray to the level surface that has the height `level_m` at touch_m. It is negative if a
// ray from above misses the surface, and 0 if the ray starts below the surface.
float level_distance_m(vec3 origin_m, vec3 ray, float level_m) {
  vec2 off_m = origin_m.xy - touch_m;
  float above_m = origin_m.z - level_m + 0.5 * ground_curvature_per_m * dot(off_m, off_m);
  if (above_m <= 0.0) return 0.0;
  float closing = -ray.z - ground_curvature_per_m * dot(off_m, ray.xy);
  float discriminant = closing * closing - 2.0 * ground_curvature_per_m * dot(ray.xy, ray.xy) * above_m;
  if (closing <= 0.0 || discriminant < 0.0) return -1.0;
  return 2.0 * above_m / (closing + sqrt(discriminant));
}

#if RELIEF
layout(binding = kTerrainUnit) uniform sampler2D terrain;  // height above sea level

uniform vec2 terrain_from_ground_scale;  // texture coordinates per metre
uniform vec2 terrain_from_ground_offset;
uniform float terrain_offset_m;  // height of sea level in these coordinates
uniform float highest_ground_m;
uniform float steepest_ground;  // largest slope of the terrain, as a tangent

float terrain_m(vec2 place_m) {
  return texture(terrain, place_m * terrain_from_ground_scale + terrain_from_ground_offset).r + terrain_offset_m;
}

float above_ground_m(vec3 point_m) {
  vec2 off_m = point_m.xy - touch_m;
  return point_m.z - terrain_m(point_m.xy) + 0.5 * ground_curvature_per_m * dot(off_m, off_m);
}

vec3 ground_normal(vec2 place_m) {
  vec2 step_m = 1.0 / (terrain_from_ground_scale * vec2(textureSize(terrain, 0)));
  float east = terrain_m(place_m + vec2(step_m.x, 0.0)) - terrain_m(place_m - vec2(step_m.x, 0.0));
  float north = terrain_m(place_m + vec2(0.0, step_m.y)) - terrain_m(place_m - vec2(0.0, step_m.y));
  return normalize(vec3(-0.5 * east / step_m.x, -0.5 * north / step_m.y, 1.0));
}
#endif

// Returns the distance along the ray to the ground. It is negative if the ray misses the ground or starts below it. No
// step is longer than the steepest slope allows, so that no mountain is missed. The number of steps is limited. A ray
// that grazes the ground for very long ends at its last step.
float ground_distance_m(vec3 origin_m, vec3 ray) {
  float lowest = level_distance_m(origin_m, ray, lowest_ground_m);
#if !RELIEF
  return lowest > 0.0 ? min(lowest, kFarthestGround_m) : -1.0;
#else
  float distance_m = level_distance_m(origin_m, ray, highest_ground_m);
  if (distance_m < 0.0 || above_ground_m(origin_m) <= 0.0) return -1.0;
  float end_m = lowest > 0.0 ? lowest : kFarthestGround_m;
  float level = length(ray.xy);
  float bend = ground_curvature_per_m * (length(origin_m.xy - touch_m) + end_m) * level;
  float closing = max(steepest_ground * level - ray.z + bend, 1e-4);
  for (int i = 0; i < 128 && distance_m < end_m; ++i) {
    float gap_m = above_ground_m(origin_m + distance_m * ray);
    if (gap_m < 0.5 + 1e-4 * distance_m) return distance_m;
    distance_m += gap_m / closing;
  }
  if (distance_m < end_m) return distance_m;
  return lowest > 0.0 ? min(lowest, kFarthestGround_m) : -1.0;
#endif
}
