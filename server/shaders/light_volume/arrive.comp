// The light that arrives at the centres of cells that a ray may meet: a work group for each block of them
// (volume::CellBlocks). Next to the cell the medium is sampled towards the sun; from there on the sun-aligned volume of
// carry.comp holds what the light has lost. Cells' centres are where the medium's linear interpolation has its kinks, so
// that in a cloud's edge, where extinction rises linearly from such a centre, the square root of the light's optical depth
// rises linearly too.
// r: the square root of the light's optical depth; g: the mean intensity of light scattered many times, over the sun's
// irradiance. Variants: GROUPS, CONSISTENT, TRANSLUCENT, DIFFUSE.
#include "common/medium.glsl"
#include "physics/light_transport.glsl"

layout(local_size_x = 32) in;
layout(binding = 0) uniform writeonly image3D arrived;

layout(binding = 4) uniform sampler3D carried;
layout(binding = 5) uniform sampler2D thickness;
layout(std430, binding = 0) readonly buffer Blocks { uint blocks[]; };  // as volume::CellBlocks has them

uniform ivec3 cell_count;
uniform ivec3 cells_per_block;
uniform int block_count;
uniform mat4x3 light_from_local;
uniform vec3 towards_sun;
uniform float near_m;  // sampled next to the cell
uniform vec4 light_weights[PLANES];

const int kNearSamples = 4;
const uint kThickBlock = 1u << 31;

// What give_light needs in the coordinates of the medium's texture and of the light's volume.
struct Surroundings {
  vec3 low_place;  // of the medium's box
  vec3 high_place;
  int near_samples;
  vec3 near_step;          // between samples towards the sun
  vec4 near_depths[PLANES];  // texel to the optical depth of such a step
  float light_layers;
};

// `far_place` is where the light's volume takes over, `here_place` the cell's own place in it.
void give_light(ivec3 cell, vec3 place, vec3 here_place, vec3 far_place, Surroundings around) {
  float depth = 0.0;
  for (int i = 0; i < around.near_samples; ++i) {
    vec3 sample_place = place + (float(i) + 0.5) * around.near_step;
    bool inside = all(greaterThanEqual(sample_place, around.low_place)) &&
                  all(lessThanEqual(sample_place, around.high_place));
    depth += inside ? weigh(medium_at_place(sample_place), around.near_depths) : 0.0;
  }
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
  uint listed = gl_WorkGroupID.x + gl_NumWorkGroups.x * gl_WorkGroupID.y;
  if (listed >= uint(block_count)) return;
  uint packed_block = blocks[listed];
  ivec3 block = ivec3(packed_block & 1023u, packed_block >> 10 & 1023u, packed_block >> 20 & 1023u);
  // What is thin takes little light on the way past a cell; the paper's transport depends on the steps of carry.comp.
  bool thick = (packed_block & kThickBlock) != 0u;
  bool looks_near = thick && (CONSISTENT == 1 || TRANSLUCENT == 0);
  float step_m = near_m / float(kNearSamples);
  Surroundings around;
  around.low_place = medium_low_m * texture_from_local_scale + texture_from_local_offset;
  around.high_place = medium_high_m * texture_from_local_scale + texture_from_local_offset;
  around.near_samples = looks_near ? kNearSamples : 0;
  around.near_step = step_m * towards_sun * texture_from_local_scale;
  around.near_depths = scaled(light_weights, step_m);
  around.light_layers = float(textureSize(carried, 0).z);

  ivec3 first_cell = block * cells_per_block;
  vec3 cell_size = 1.0 / vec3(cell_count);
  vec3 cell_m = cell_size / texture_from_local_scale;
  vec3 first_m = (vec3(first_cell) + 0.5) * cell_m - texture_from_local_offset / texture_from_local_scale;
  mat3 light_step = mat3(light_from_local[0] * cell_m.x, light_from_local[1] * cell_m.y, light_from_local[2] * cell_m.z);
  vec3 first_place = light_from_local * vec4(first_m, 1.0);
  vec3 to_far = mat3(light_from_local) * (looks_near ? near_m * towards_sun : vec3(0.0));

  ivec3 cells_left = min(cells_per_block, cell_count - first_cell);
  int cells = cells_per_block.x * cells_per_block.y * cells_per_block.z;
  // Not by integers: software divides those one by one.
  float per_row = 1.0 / float(cells_per_block.x);
  float per_layer = per_row / float(cells_per_block.y);
  for (int i = int(gl_LocalInvocationIndex); i < cells; i += 32) {
    int row = int((float(i) + 0.5) * per_row);
    int layer = int((float(i) + 0.5) * per_layer);
    ivec3 within = ivec3(i - row * cells_per_block.x, row - layer * cells_per_block.y, layer);
    if (any(greaterThanEqual(within, cells_left))) continue;
    ivec3 cell = first_cell + within;
    vec3 here_place = first_place + light_step * vec3(within);
    give_light(cell, (vec3(cell) + 0.5) * cell_size, here_place, here_place + to_far, around);
  }
}
