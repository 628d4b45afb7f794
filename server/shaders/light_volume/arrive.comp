// The light that arrives at the centres of the cells of occupied bricks: a work group for each brick. Next to the cell the medium is sampled towards the
// sun; from there on the sun-aligned volume of carry.comp holds what the light has lost. Cells' centres are where the
// medium's linear interpolation has its kinks, so that in a cloud's edge, where extinction rises linearly from such a
// centre, the square root of the light's optical depth rises linearly too.
// r: the square root of the light's optical depth; g: the mean intensity of light scattered many times, over the sun's
// irradiance. Variants: GROUPS, CONSISTENT, TRANSLUCENT, DIFFUSE.
#include "common/medium.glsl"
#include "common/bricks.glsl"
#include "physics/light_transport.glsl"

layout(local_size_x = 32) in;
layout(binding = 0) uniform writeonly image3D arrived;

layout(binding = 4) uniform sampler3D carried;
layout(binding = 5) uniform sampler2D thickness;
layout(std430, binding = 0) readonly buffer Bricks { uint occupied_bricks[]; };  // x + 1024 (y + 1024 z)

uniform ivec3 cell_count;
uniform ivec3 cells_per_brick;
uniform int occupied_count;
uniform mat4x3 light_from_local;
uniform vec3 towards_sun;
uniform float near_m;  // sampled next to the cell
uniform vec4 light_weights[PLANES];

const int kNearSamples = 4;

void give_light(ivec3 cell, bool thick) {
  vec3 place = (vec3(cell) + 0.5) / vec3(cell_count);
  vec3 local_m = (place - texture_from_local_offset) / texture_from_local_scale;
  // What is thin takes little light on the way past a cell; the paper's transport depends on the steps of carry.comp.
  bool looks_near = thick && (CONSISTENT == 1 || TRANSLUCENT == 0);
  int samples = looks_near ? kNearSamples : 0;
  float reach_m = looks_near ? near_m : 0.0;
  float step_m = near_m / float(kNearSamples);
  float depth = 0.0;
  for (int i = 0; i < samples; ++i) {
    vec3 sample_m = local_m + (float(i) + 0.5) * step_m * towards_sun;
    float inside = inside_medium(sample_m) ? step_m : 0.0;
    depth += weigh(medium_at(sample_m), light_weights) * inside;
  }
  vec3 far_place = light_from_local * vec4(local_m + reach_m * towards_sun, 1.0);
  // Between the sun's side of the volume and the middle of its first layer light begins to fade.
  float begun = clamp(2.0 * float(textureSize(carried, 0).z) * far_place.z, 0.0, 1.0);
  float far = begun * texture(carried, far_place).r;
  float multiple = 0.0;
#if DIFFUSE
  vec3 here_place = light_from_local * vec4(local_m, 1.0);
  float total = texture(thickness, here_place.xy).r;
  // Diffuse light that leaves a cloud comes from one transport mean free path (2/3 by Eddington) inside it.
  multiple = diffuse_mean_intensity(min(texture(carried, here_place).g + 2.0 / 3.0, total), total);
#endif
  imageStore(arrived, cell, vec4(sqrt(depth + far * far), multiple, 0.0, 0.0));
}

void main() {
  uint listed = gl_WorkGroupID.x + gl_NumWorkGroups.x * gl_WorkGroupID.y;
  if (listed >= uint(occupied_count)) return;
  uint packed_brick = occupied_bricks[listed];
  ivec3 brick = ivec3(packed_brick & 1023u, packed_brick >> 10 & 1023u, packed_brick >> 20);
  bool thick = texelFetch(bricks, brick, 0).r == kThickBrick;
  int cells = cells_per_brick.x * cells_per_brick.y * cells_per_brick.z;
  for (int i = int(gl_LocalInvocationIndex); i < cells; i += 32) {
    ivec3 within = ivec3(i, i / cells_per_brick.x, i / (cells_per_brick.x * cells_per_brick.y)) % cells_per_brick;
    ivec3 cell = brick * cells_per_brick + within;
    if (all(lessThan(cell, cell_count))) give_light(cell, thick);
  }
}
