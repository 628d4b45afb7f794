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

const int kMostSamples = 4096;
const float kOpaque = 12.0;

void main() {
  vec3 origin_m = position.x * light_right_m + position.y * light_up_m;
  vec3 ray = mix(towards_sun, vec3(1e-7), lessThan(abs(towards_sun), vec3(1e-7)));
  vec3 low_m = (medium_low_m - origin_m) / ray;
  vec3 high_m = (medium_high_m - origin_m) / ray;
  vec3 nearest = min(low_m, high_m);
  vec3 farthest = max(low_m, high_m);
  float way_m = max(nearest.x, max(nearest.y, nearest.z));
  float end_m = min(farthest.x, min(farthest.y, farthest.z));
  vec3 brick_step = ray * brick_from_local_scale;
  vec3 brick_start = origin_m * brick_from_local_scale + brick_from_local_offset;
  vec3 per_brick_step = 1.0 / brick_step;
  float depth = 0.0;
  for (int i = 0; i < kMostSamples && way_m < end_m && depth < kOpaque; ++i) {
    vec3 brick_place = brick_start + way_m * brick_step;
    uint content = brick_content(brick_place);
    if (content != kThickBrick && content != kThinBrick) {
      way_m += empty_way(brick_place, content, per_brick_step);
      continue;
    }
    float path_m = min(step_m, end_m - way_m);
    depth += path_m * weigh(medium_at(origin_m + (way_m + 0.5 * path_m) * ray), light_weights);
    way_m += path_m;
  }
  blocked = 1.0 - exp(-depth);
}
