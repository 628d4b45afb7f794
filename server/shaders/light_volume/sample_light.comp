// The light that has arrived (arrive.comp), at the cells of the diffusion equation: the root of its optical depth.
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0, r32f) uniform writeonly image3D light;
layout(binding = 4) uniform sampler3D arrived;

uniform ivec3 cell_count;

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, cell_count))) return;
  imageStore(light, cell, vec4(texture(arrived, (vec3(cell) + 0.5) / vec3(cell_count)).r, 0.0, 0.0, 0.0));
}
