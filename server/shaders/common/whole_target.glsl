// The last part of the compute shader that runs the code of a fragment shader (gl/computed_target.h). Each invocation
// draws one pixel of a gl::WholeTarget.
#include "common/bindings.glsl"

layout(local_size_x = kTargetGroupSide, local_size_y = kTargetGroupSide) in;

layout(binding = kTargetLimitUnit) uniform sampler2D target_limit;  // depth texture of a cover
uniform ivec2 target_size;
uniform ivec2 first_pixel;
uniform ivec2 end_pixel;
uniform int limited_to;  // selects pixels by that depth: 1 above 0.5, -1 below 0.5, 0 all

bool is_drawn(ivec2 pixel) {
  if (any(greaterThanEqual(pixel, end_pixel))) return false;
  return limited_to == 0 || (texelFetch(target_limit, pixel, 0).r - 0.5) * float(limited_to) > 0.0;
}

void main() {
  ivec2 pixel = first_pixel + ivec2(gl_GlobalInvocationID.xy);
  if (!is_drawn(pixel)) return;
  pixel_centre = vec4(vec2(pixel) + 0.5, 0.0, 1.0);
  position = 2.0 * pixel_centre.xy / vec2(target_size) - 1.0;
  draw_pixel();
  store_pixel(pixel);
}
