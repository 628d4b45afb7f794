// Computes the light that arrives at the centres of cells that a ray may meet. One work group processes one block of
// cells (volume::CellBlocks). Close to the cell, the medium is sampled towards the sun. Farther away, the optical depth
// comes from the volume of carry.comp, which is aligned with the sun.
//
// r is the square root of the optical depth of the arriving light. Extinction is linear between
// cell centres. At a cloud's edge it rises from 0 at a cell centre, so the optical depth rises
// quadratically, and its square root can be interpolated linearly. g is the mean intensity of
// multiply scattered light, divided by the sun's irradiance.
//
// Variants: GROUPS, DETAILS, CONSISTENT, TRANSLUCENT, DIFFUSE, NEAR. NEAR concerns the path close to a cell. Its
// optical depth in the medium is divided by its optical depth in the light's medium (light_medium.comp). This ratio
// changes little while the sun moves. With NEAR 1 the ratio is stored. With NEAR 2 the stored ratio is used, and the
// medium is not sampled.
#include "common/bindings.glsl"
#include "common/medium.glsl"
#include "common/box.glsl"
#include "light_volume/cell_blocks.glsl"
#if NEAR > 0
#include "light_volume/light_medium.glsl"
#endif
#include "physics/light_transport.glsl"

layout(binding = kArrivedImage) uniform writeonly image3D arrived;

layout(binding = kCarriedUnit) uniform sampler3D carried;
layout(binding = kThicknessUnit) uniform sampler2D thickness;
#if NEAR == 1
layout(binding = kNearRatioImage) uniform writeonly image3D near_ratio;
#elif NEAR == 2
layout(binding = kNearRatioUnit) uniform sampler3D near_ratio;
#endif

uniform mat4x3 light_from_local;
uniform vec3 towards_sun;
uniform float near_m;  // length of the path next to a cell along which the medium is sampled
uniform vec4 light_weights[PLANES];

// Number of samples, which are at the two Gauss-Legendre points. Compared with 64 samples, no pixel of the mature storm
// changes by more than 1 of 255.
const int kNearSamples = 2;
const float kFirstNearSample = 0.21132487;
const float kNearSamplesApart = 0.57735027;

// kRatioOne is the texel value of a ratio of 1, so ratios up to nearly 2 can be stored. kLeastNearDepth is added to
// both optical depths, because ratios of tiny depths are meaningless.
const float kRatioOne = 128.0 / 255.0;
const float kLeastNearDepth = 0.01;

// Inputs of give_light that all cells have in common. Places are in the coordinates of the medium's texture and of the
// light's volume.
struct Surroundings {
  int near_samples;
  vec3 near_path;  // vector towards the sun along which the medium is sampled
  vec3 per_near_path;
  vec3 out_place;  // end of the medium's box in the sun's direction
  vec4 near_depths[PLANES];  // factors from a texel to the contribution of a sample to the optical depth of that path
  float near_smoother;  // the corresponding factor for the light's medium
  float light_layers;
};

// Computes the light of one cell. `here_place` is the cell's place in the light's volume.
// `far_place` is the place of the sampled path's end in the light's volume.
void give_light(ivec3 cell, vec3 place, vec3 here_place, vec3 far_place, Surroundings around) {
  // Only the part of the sampled path inside the medium's box counts. A block of cells may extend beyond the box.
  vec3 inside = (around.out_place - place) * around.per_near_path;
  float share = clamp(min(min(inside.x, inside.y), inside.z), 0.0, 1.0);
  float depth = 0.0;  // optical depth in the medium
  float smoother = 0.0;  // optical depth in the light's medium
  for (int i = 0; i < around.near_samples; ++i) {
    vec3 at = place + share * (kFirstNearSample + kNearSamplesApart * float(i)) * around.near_path;
#if NEAR < 2
    depth += share * weigh(medium_at_place(at, 0.0), around.near_depths);
#endif
#if NEAR > 0
    smoother += share * around.near_smoother * texture(light_medium, at).r;
#endif
  }
#if NEAR == 1
  imageStore(near_ratio, cell, vec4(kRatioOne * (depth + kLeastNearDepth) / (smoother + kLeastNearDepth)));
#elif NEAR == 2
  float ratio = texelFetch(near_ratio, cell, 0).r / kRatioOne;
  depth = max(ratio * (smoother + kLeastNearDepth) - kLeastNearDepth, 0.0);
#endif
  // The carried optical depth fades in between the sun's side of the volume and the middle of its first layer.
  float begun = clamp(2.0 * around.light_layers * far_place.z, 0.0, 1.0);
  float far = begun * texture(carried, far_place).r;
  float multiple = 0.0;
#if DIFFUSE
  float total = texture(thickness, here_place.xy).r;
  // Diffuse light that leaves a cloud comes from one transport mean free path (2/3 by Eddington) below its surface.
  multiple = diffuse_mean_intensity(min(texture(carried, here_place).g + 2.0 / 3.0, total), total);
#endif
  imageStore(arrived, cell, vec4(sqrt(depth + far * far), multiple, 0.0, 0.0));
}

void main() {
  begin_medium();
  Block block = block_of_group();
  if (!block.listed) return;
  // In a thin block, the optical depth near a cell is negligible. The paper's transport must use only the steps of
  // carry.comp.
  bool looks_near = block.thick && (CONSISTENT == 1 || TRANSLUCENT == 0);
  vec3 direction = safe_direction(towards_sun);
  vec3 box_low = medium_low_m * texture_from_local_scale + texture_from_local_offset;
  vec3 box_high = medium_high_m * texture_from_local_scale + texture_from_local_offset;
  Surroundings around;
  around.near_samples = looks_near ? kNearSamples : 0;
  around.near_path = near_m * direction * texture_from_local_scale;
  around.per_near_path = 1.0 / around.near_path;
  around.out_place = mix(box_low, box_high, greaterThan(direction, vec3(0.0)));
  around.near_depths = scaled(light_weights, near_m / float(kNearSamples));
#if NEAR > 0
  around.near_smoother = light_medium_per_m * near_m / float(kNearSamples);
#endif
  around.light_layers = float(textureSize(carried, 0).z);

  vec3 cell_size = 1.0 / vec3(cell_count);
  vec3 cell_m = cell_size / texture_from_local_scale;
  vec3 first_m = (vec3(block.first_cell) + 0.5) * cell_m - texture_from_local_offset / texture_from_local_scale;
  mat3 light_step = mat3(light_from_local[0] * cell_m.x, light_from_local[1] * cell_m.y, light_from_local[2] * cell_m.z);
  vec3 first_place = light_from_local * vec4(first_m, 1.0);
  vec3 to_far = mat3(light_from_local) * (looks_near ? near_m * towards_sun : vec3(0.0));

  ivec3 cells_left = min(cells_per_block, cell_count - block.first_cell);
  for (int i = int(gl_LocalInvocationIndex); i < block.cells; i += kBlockGroupSize) {
    ivec3 within = cell_within(block, i);
    if (any(greaterThanEqual(within, cells_left))) continue;
    ivec3 cell = block.first_cell + within;
    vec3 here_place = first_place + light_step * vec3(within);
    give_light(cell, (vec3(cell) + 0.5) * cell_size, here_place, here_place + to_far, around);
  }
}
