// The light that arrives at the centres of cells that a ray may meet: a work group for each block of them
// (volume::CellBlocks). Next to the cell the medium is sampled towards the sun; from there on the sun-aligned volume of
// carry.comp holds what the light has lost. Cells' centres are where the medium's linear interpolation has its kinks, so
// that in a cloud's edge, where extinction rises linearly from such a centre, the square root of the light's optical depth
// rises linearly too.
// r: the square root of the light's optical depth; g: the mean intensity of light scattered many times, over the sun's
// irradiance. Variants: GROUPS, DETAILS, CONSISTENT, TRANSLUCENT, DIFFUSE; NEAR: of the optical depth next to a cell by the
// medium over that by the light's medium (light_medium.comp), which changes little while the sun moves, 1 keeps the ratio, 2
// takes it in place of the medium.
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
uniform float near_m;  // sampled next to the cell
uniform vec4 light_weights[PLANES];

// At Gauss and Legendre's two places. Against 64 samples no pixel of the mature storm changes by more than 1 of 255.
const int kNearSamples = 2;
const float kFirstNearSample = 0.21132487;
const float kNearSamplesApart = 0.57735027;

// The texel of a ratio of 1; ratios up to nearly 2 are kept, between optical depths with this added: next to nothing they mean nothing.
const float kRatioOne = 128.0 / 255.0;
const float kLeastNearDepth = 0.01;

// Inputs of give_light that cells share, in the coordinates of the medium's texture and of the light's volume.
struct Surroundings {
  int near_samples;
  vec3 near_path;            // sampled towards the sun
  vec3 per_near_path;
  vec3 out_place;            // where the medium's box ends towards the sun
  vec4 near_depths[PLANES];  // texel to a sample's share of the optical depth of that path
  float near_smoother;       // the same of the light's medium
  float light_layers;
};

// `far_place` is where the light's volume takes over, `here_place` the cell's own place in it.
void give_light(ivec3 cell, vec3 place, vec3 here_place, vec3 far_place, Surroundings around) {
  // The part of that path inside the medium's box; a block reaches beyond it.
  vec3 inside = (around.out_place - place) * around.per_near_path;
  float share = clamp(min(min(inside.x, inside.y), inside.z), 0.0, 1.0);
  float depth = 0.0;    // by the medium
  float smoother = 0.0;  // by the light's medium
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
  // Between the sun's side of the volume and the middle of its first layer light begins to fade.
  float begun = clamp(2.0 * around.light_layers * far_place.z, 0.0, 1.0);
  float far = begun * texture(carried, far_place).r;
  float multiple = 0.0;
#if DIFFUSE
  float total = texture(thickness, here_place.xy).r;
  // Diffuse light that leaves a cloud comes from one transport mean free path (2/3 by Eddington) inside it.
  multiple = diffuse_mean_intensity(min(texture(carried, here_place).g + 2.0 / 3.0, total), total);
#endif
  imageStore(arrived, cell, vec4(sqrt(depth + far * far), multiple, 0.0, 0.0));
}

void main() {
  begin_medium();
  Block block = block_of_group();
  if (!block.listed) return;
  // A thin block takes little light near a cell; the paper's transport depends on the steps of carry.comp.
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
