// Computes the similarity-scaled optical depth along each whole sun ray, summed over slices that are perpendicular to
// the ray. Variants: GROUPS, DETAILS.
#include "common/bindings.glsl"
#include "common/medium.glsl"
#include "common/bricks.glsl"
#include "half_angle/bindings.glsl"
#include "half_angle/slice_light.glsl"

layout(local_size_x = kLightGroupSide, local_size_y = kLightGroupSide) in;
layout(binding = kSliceThicknessImage) uniform writeonly image2D thickness;

uniform ivec2 texel_count;
uniform int slice_count;
uniform vec4 transport_weights[PLANES];

void main() {
  begin_medium();
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(texel, texel_count))) return;
  SunRay ray = sun_ray((vec2(texel) + 0.5) / vec2(texel_count));
  vec4 transport_depths[PLANES] = scaled(transport_weights, light_path_m);
  float path_m = light_path_m;
  float slice = max(ceil((ray.inside.x - ray.first_m) / path_m), 0.0);
  float end = min(floor((ray.inside.y - ray.first_m) / path_m) + 1.0, float(slice_count));
  float depth = 0.0;
  while (slice < end) {
    float distance_m = ray.first_m + slice * path_m;
    vec3 place = brick_place(ray.medium, distance_m);
    uint content = brick_content(ray.medium, place);
    bool meets = is_filled(content);
    slice = max(slice + 1.0, meets ? 0.0 : ceil((distance_m + empty_path(ray.medium, place, content) - ray.first_m) / path_m));
    if (meets) depth += weigh(medium_at_place(medium_place(ray.medium, distance_m), 0.0), transport_depths);
  }
  imageStore(thickness, texel, vec4(depth, 0.0, 0.0, 0.0));
}
