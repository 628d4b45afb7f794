// The share of sunlight that the whole medium keeps from what lies behind it, along one sun ray a texel. Variants: GROUPS, DETAILS.
#include "common/medium.glsl"
#include "common/bricks.glsl"

uniform vec3 towards_sun;
uniform vec3 light_right_m;  // metres across the picture's half width and height, from the middle of the box
uniform vec3 light_up_m;
uniform float step_m;
uniform vec4 light_weights[PLANES];

in vec2 position;
out float blocked;

const int kMaxSamples = 4096;
const float kOpaque = 12.0;

void main() {
  begin_medium();
  vec3 origin_m = position.x * light_right_m + position.y * light_up_m;
  vec3 direction = safe_direction(towards_sun);
  MediumRay ray = medium_ray(origin_m, direction);
  vec2 way = way_in_medium(origin_m, direction, 0.0);
  vec4 depth_weights[PLANES] = scaled(light_weights, step_m);
  float per_step = 1.0 / step_m;
  float way_m = way.x;
  float depth = 0.0;
  for (int i = 0; i < kMaxSamples && way_m < way.y && depth < kOpaque; ++i) {
    vec3 place = brick_place(ray, way_m);
    uint content = brick_content(ray, place);
    if (!is_filled(content)) {
      way_m += empty_way(ray, place, content);
      continue;
    }
    float path_m = min(step_m, way.y - way_m);
    depth += path_m * per_step * weigh(medium_at_place(medium_place(ray, way_m + 0.5 * path_m)), depth_weights);
    way_m += path_m;
  }
  blocked = 1.0 - exp(-depth);
}
