// Computes the medium's shadow along one sun ray for each texel, in the format of common/storm_shadow.glsl. Variants:
// GROUPS, DETAILS.
#include "common/medium.glsl"
#include "common/bricks.glsl"

uniform vec3 towards_sun;
// light_right_m is the vector from the middle of the box to the right edge of the shadow map, light_up_m to its upper
// edge.
uniform vec3 light_right_m;
uniform vec3 light_up_m;
uniform float half_depth_m;  // half the depth of the box along the sun's rays
uniform float step_m;
uniform vec4 light_weights[PLANES];

in vec2 position;
out vec4 shadow;

const int kMaxSamples = 4096;
const float kOpaqueDepth = 12.0;  // a ray ends at this optical depth

void main() {
  begin_medium();
  vec3 origin_m = position.x * light_right_m + position.y * light_up_m;
  vec3 direction = safe_direction(-towards_sun);
  MediumRay ray = medium_ray(origin_m, direction);
  vec2 path = path_in_medium(origin_m, direction, 0.0);
  vec4 depth_weights[PLANES] = scaled(light_weights, step_m);
  float per_step = 1.0 / step_m;
  float distance_m = path.x;
  float depth = 0.0;
  float before = 1.0;  // transmittance of the ray so far
  vec2 moments = vec2(0.0);
  for (int i = 0; i < kMaxSamples && distance_m < path.y && depth < kOpaqueDepth; ++i) {
    vec3 place = brick_place(ray, distance_m);
    uint content = brick_content(ray, place);
    if (!is_filled(content)) {
      distance_m += empty_path(ray, place, content);
      continue;
    }
    float path_m = min(step_m, path.y - distance_m);
    depth += path_m * per_step * weigh(medium_at_place(medium_place(ray, distance_m + 0.5 * path_m), 0.0), depth_weights);
    float after = exp(-depth);
    float along = (distance_m + 0.5 * path_m) / half_depth_m;
    moments += (before - after) * vec2(along, along * along);
    before = after;
    distance_m += path_m;
  }
  shadow = vec4(1.0 - before, moments, 0.0);
}
