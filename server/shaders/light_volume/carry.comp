// Carries sunlight once through the medium into a volume whose depth runs along the sun's rays: one invocation a ray.
// r: the square root of the light's effective optical depth, -log of the share that arrives; g: the similarity-scaled
// optical depth passed, whose end is the ray's thickness.
// Layers that interpolation inside the medium's box does not reach are left as they are.
// Variants: GROUPS, CONSISTENT, TRANSLUCENT, DIFFUSE. The light model is that of half_angle/light.frag but for the
// exchange with neighbouring rays, whose width (one cell's path at 3/8 theta_f) is below a texel of this volume at the
// usual angles.
#include "common/medium.glsl"
#include "common/bricks.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) uniform writeonly image3D carried;
#if DIFFUSE
layout(binding = 1, r32f) uniform writeonly image2D thickness;
#endif

uniform ivec3 light_size;
uniform vec3 towards_sun;
uniform vec3 light_right_m;  // metres across the volume's half width and height
uniform vec3 light_up_m;
uniform float light_reach_m;  // half its depth
uniform float texel_m;        // the longest side of a texel
uniform int half_layer_steps;  // samples in half a layer
uniform vec4 light_weights[PLANES];
uniform vec4 transport_weights[PLANES];
uniform vec2 cumulative_phase;  // CP(theta_f / 4), CP(theta_f / 2)

// Bricks from an occupied one within which arrive.comp reads this volume: it looks 1.5 texels towards the sun, and
// interpolates over one more; a brick is at least 2 texels wide.
const uint kReadBricks = 2u;

// Optical depth that the light loses along `path_m` with extinction `extinction`.
float lost(float extinction, float path_m) {
  float depth = extinction * path_m;
#if CONSISTENT || !TRANSLUCENT
  return depth;
#else
  // Riley et al. 2003 (Vis), eq. 14 to 17 as printed, in a light that does not vary across the rays.
  return depth < 1e-3 ? depth * (1.0 - cumulative_phase.y)
                      : -log(mix(exp(-depth), 1.0, cumulative_phase.y));
#endif
}

void main() {
  ivec2 ray = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(ray, light_size.xy))) return;
  vec2 across = (vec2(ray) + 0.5) / vec2(light_size.xy) * 2.0 - 1.0;
  vec3 start_m = across.x * light_right_m + across.y * light_up_m + light_reach_m * towards_sun;
  float layer_m = 2.0 * light_reach_m / float(light_size.z);
  float step_m = 0.5 * layer_m / float(half_layer_steps);

  // Where the ray passes through the box, or so near that interpolation in the box reaches it.
  vec3 against_sun = mix(-towards_sun, vec3(1e-7), lessThan(abs(towards_sun), vec3(1e-7)));
  vec3 low_m = (medium_low_m - 1.5 * texel_m - start_m) / against_sun;
  vec3 high_m = (medium_high_m + 1.5 * texel_m - start_m) / against_sun;
  vec3 nearest = min(low_m, high_m);
  vec3 farthest = max(low_m, high_m);
  float enters_m = max(nearest.x, max(nearest.y, nearest.z));
  float leaves_m = min(farthest.x, min(farthest.y, farthest.z));
  int first = clamp(int(floor(enters_m / layer_m)), 0, light_size.z);
  int last = leaves_m < enters_m ? 0 : clamp(int(ceil(leaves_m / layer_m)), 0, light_size.z);

  float depth = 0.0;
  float transport = 0.0;
  float way_m = float(first) * layer_m + 0.5 * step_m;
  float half_layer_m = 0.5 * layer_m;
  vec3 per_brick_step = 1.0 / (against_sun * brick_from_local_scale);
  int half_layer = 2 * first;
  while (half_layer < 2 * last) {
    if ((half_layer & 1) == 1) {
      imageStore(carried, ivec3(ray, half_layer >> 1), vec4(sqrt(depth), transport, 0.0, 0.0));
    }
    vec3 brick_place = (start_m - way_m * towards_sun) * brick_from_local_scale + brick_from_local_offset;
    ivec3 brick = ivec3(floor(brick_place));
    bool outside = any(lessThan(brick, ivec3(0))) || any(greaterThanEqual(brick, brick_count));
    uint content = brick_content(brick_place);
    if (!outside && content != kThinBrick && content > kReadBricks) {
      // So far from all that scatters nothing reads the light.
      float leap_m = empty_way(brick_place, content - kReadBricks, per_brick_step);
      int leap = max(2 * int(leap_m / layer_m), 2);  // whole layers: stores keep their turn
      half_layer += leap;
      way_m += float(leap) * half_layer_m;
      continue;
    }
    int steps = outside || (content != kThickBrick && content != kThinBrick) ? 0 : half_layer_steps;
    for (int i = 0; i < steps; ++i) {
      vec3 local_m = start_m - (way_m + float(i) * step_m) * towards_sun;
      Medium medium = medium_at(local_m);
      float inside = inside_medium(local_m) ? step_m : 0.0;
      depth += lost(weigh(medium, light_weights), inside);
      transport += weigh(medium, transport_weights) * inside;
    }
    ++half_layer;
    way_m += half_layer_m;
  }

#if DIFFUSE
  imageStore(thickness, ray, vec4(transport, 0.0, 0.0, 0.0));
#endif
}
