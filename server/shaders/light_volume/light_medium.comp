// Computes the medium for propagating light, with one value for each cell. A sample along the sun's rays then reads one
// texture, whatever the number of groups and noises. With detail, the value is the mean over the cell, which preserves
// the attenuation of light. The only exception is the part of the mean that spreads into cells of empty bricks, which
// carry.comp skips. r is the extinction for light. g is the similarity-scaled extinction, in textures that have this
// channel. Both are divided by `light_medium_per_m`. Variants: GROUPS, DETAILS.
#include "common/bindings.glsl"
#include "common/medium.glsl"
#include "light_volume/cell_blocks.glsl"

layout(binding = kLightMediumImage) uniform writeonly image3D light_medium;

uniform vec4 light_weights[PLANES];  // from the medium's texel to the stored value
uniform vec4 transport_weights[PLANES];

#if DETAILS > 0
// Corners of a tetrahedron. For a trilinear function, the mean of samples at these four corners is nearly that of samples
// at a cube's eight corners. Only the term with the product of all three coordinates differs.
const vec3 kWithin[4] = vec3[4](vec3(-0.25, -0.25, -0.25), vec3(0.25, 0.25, -0.25), vec3(0.25, -0.25, 0.25),
                                vec3(-0.25, 0.25, 0.25));
#else
// The medium is linear between cell centres, so one sample is enough.
const vec3 kWithin[1] = vec3[1](vec3(0.0));
#endif

void main() {
  begin_medium();
  Block block = block_of_group();
  if (!block.listed) return;
  vec3 cell_size = 1.0 / vec3(cell_count);
  for (int i = int(gl_LocalInvocationIndex); i < block.cells; i += kBlockGroupSize) {
    ivec3 cell = block.first_cell + cell_within(block, i);
    if (any(greaterThanEqual(cell, cell_count))) continue;
    vec3 middle = (vec3(cell) + 0.5) * cell_size;
    vec2 sum = vec2(0.0);
    for (int k = 0; k < kWithin.length(); ++k) {
      Medium medium = medium_at_place(middle + kWithin[k] * cell_size, 0.0);
      sum += vec2(weigh(medium, light_weights), weigh(medium, transport_weights));
    }
    imageStore(light_medium, cell, vec4(sum / float(kWithin.length()), 0.0, 0.0));
  }
}
