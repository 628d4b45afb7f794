// Propagates sunlight once through the medium into a volume whose depth is along the sun's rays, with one invocation
// for each ray. r is the square root of the light's effective optical depth, which is -log of the arriving share. g is
// the similarity-scaled optical depth from the sun. At the end of a ray, g is the ray's thickness. `shadow` is the
// shadow of the whole medium (common/storm_shadow.glsl). Layers that arrive.comp does not use stay unchanged.
//
// The light model is that of half_angle/carry.comp without the exchange of light between neighbouring rays. At the
// usual angles, the width of that exchange (3/8 theta_f times the path through a cell) is less than a texel of this
// volume. Variants: CONSISTENT, TRANSLUCENT, DIFFUSE.
#include "common/bricks.glsl"
#include "light_volume/light_medium.glsl"

layout(local_size_x = kLightGroupSide, local_size_y = kLightGroupSide) in;
layout(binding = kCarriedImage) uniform writeonly image3D carried;
layout(binding = kShadowImage, rgba32f) uniform writeonly image2D shadow;
#if DIFFUSE
layout(binding = kThicknessImage, r32f) uniform writeonly image2D thickness;
#endif

uniform ivec3 light_size;
uniform int first_row;  // first row of this dispatch
uniform vec3 towards_sun;
// Vector from the volume's middle to its right side; light_up_m is the vector to its upper side.
uniform vec3 light_right_m;
uniform vec3 light_up_m;
uniform float light_reach_m;  // half the depth of the volume in metres
uniform float read_m;  // arrive.comp reads this volume up to this distance from scattering cells
uniform int read_bricks;  // read_m in units of bricks
uniform int half_layer_steps;  // number of samples in half a layer
uniform vec2 cumulative_phase;  // CP(theta_f / 4), CP(theta_f / 2)

// Returns the optical depth by which light is attenuated in a medium of the optical depth `depth`. `turned` is the
// share of scattered light that leaves the beam.
float lost(float depth, float turned) {
#if CONSISTENT || !TRANSLUCENT
  return depth;
#else
  // Riley et al. 2003 (Vis), eq. 14 to 17 as printed, for light that is the same for neighbouring rays.
  return depth < 1e-3 ? depth * turned : -log(1.0 - turned * (1.0 - exp(-depth)));
#endif
}

void main() {
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, first_row);
  vec2 across = (vec2(texel) + 0.5) / vec2(light_size.xy) * 2.0 - 1.0;
  vec3 start_m = across.x * light_right_m + across.y * light_up_m + light_reach_m * towards_sun;
  float layer_m = 2.0 * light_reach_m / float(light_size.z);
  float half_layer_m = 0.5 * layer_m;
  float step_m = half_layer_m / float(half_layer_steps);
  vec3 direction = safe_direction(-towards_sun);
  MediumRay ray = medium_ray(start_m, direction);
  vec2 inside = path_in_medium(start_m, direction, 0.0);
  vec2 near = path_in_medium(start_m, direction, read_m);
  int first = clamp(int(floor(near.x / layer_m)), 0, light_size.z);
  int last = near.y < near.x ? 0 : clamp(int(ceil(near.y / layer_m)), 0, light_size.z);
  float depth_of_texel = light_medium_per_m * step_m;
  float turned = 1.0 - cumulative_phase.y;
  float per_layer = 1.0 / layer_m;
  int most_steps = max(half_layer_steps, 1);
  float further_m = float(most_steps - 1) * step_m;  // distance from the first sample of a half layer to its last

  float depth = 0.0;
  float medium_depth = 0.0;
  float lit = 1.0;  // transmittance of the medium along the ray so far
  vec2 moments = vec2(0.0);
  float per_reach = 1.0 / light_reach_m;
  float transport = 0.0;
  float distance_m = float(first) * layer_m + 0.5 * step_m;
  float most_m = half_layer_m + further_m;  // distance from the first sample of a layer to its last
  int layer = first;
  if (any(greaterThanEqual(texel, light_size.xy))) return;
  while (layer < last) {
    vec3 place = brick_place(ray, distance_m);
    bool outside = any(lessThan(place, vec3(0.0))) || any(greaterThan(place, ray.highest_brick + 0.5));
    uint content = brick_content(ray, place);
    if (!outside && !is_filled(content) && content > uint(read_bricks)) {
      // arrive.comp does not read light this far from scattering cells, so these layers are skipped.
      int leap = int(empty_path(ray, place, content - uint(read_bricks)) * per_layer);
      if (leap > 0) {
        layer += leap;
        distance_m += float(leap) * layer_m;
        continue;
      }
    }
    bool empty = !is_filled(content) && empty_path(ray, place, content) > most_m;
    float depth_of_sample = empty ? 0.0 : depth_of_texel;
    for (int half_layer = 0; half_layer < 2; ++half_layer) {
#if CONSISTENT
      const int i = 0;
#else
      for (int i = 0; i < most_steps; ++i)
#endif
      {
        float at_m = distance_m + float(i) * step_m;
        float counts = at_m >= inside.x && at_m <= inside.y ? depth_of_sample : 0.0;
        vec2 depths = counts * texture(light_medium, medium_place(ray, at_m)).rg;
        medium_depth += depths.x;
        depth += lost(depths.x, turned);
        transport += depths.y;
      }
      if (half_layer == 0) imageStore(carried, ivec3(texel, layer), vec4(sqrt(depth), transport, 0.0, 0.0));
      distance_m += half_layer_m;
    }
    float left = exp(-medium_depth);
    float middle = float(layer) * layer_m * per_reach + (0.5 * layer_m * per_reach - 1.0);
    moments += (lit - left) * vec2(middle, middle * middle);
    lit = left;
    ++layer;
  }

  imageStore(shadow, texel, vec4(1.0 - lit, moments, 0.0));
#if DIFFUSE
  imageStore(thickness, texel, vec4(transport, 0.0, 0.0, 0.0));
#endif
}
