// Samples the light of arrive.comp at the cells of the diffusion equation. The result is the square root of the optical
// depth of the light that arrives at each cell.
#include "common/bindings.glsl"
#include "light_volume/bindings.glsl"

layout(local_size_x = kLightGroupSide, local_size_y = kLightGroupSide) in;
layout(binding = kSampledLightImage, r32f) uniform writeonly image3D light;
layout(binding = kArrivedUnit) uniform sampler3D arrived;

uniform ivec3 cell_count;

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, cell_count))) return;
  imageStore(light, cell, vec4(texture(arrived, (vec3(cell) + 0.5) / vec3(cell_count)).r, 0.0, 0.0, 0.0));
}
