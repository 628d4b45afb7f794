// Computes the medium as input of the diffusion equation. Each texel holds the mean extinction over the medium's own
// cells in a cell of the equation. r is the extinction for light, g the similarity-scaled extinction of transport, b
// the absorption. Variants: GROUPS, DETAILS.
#include "common/bindings.glsl"
#include "common/medium.glsl"
#include "light_volume/bindings.glsl"

layout(local_size_x = kLightGroupSide, local_size_y = kLightGroupSide) in;
layout(binding = kSampledCellsImage, rgba32f) uniform writeonly image3D cells;

uniform ivec3 cell_count;
uniform ivec3 samples;  // number of samples of the medium along each side of a cell
uniform vec4 light_weights[PLANES];
uniform vec4 transport_weights[PLANES];
uniform vec4 absorption_weights[PLANES];

void main() {
  begin_medium();
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, cell_count))) return;
  vec3 sum = vec3(0.0);
  for (int z = 0; z < samples.z; ++z) {
    for (int y = 0; y < samples.y; ++y) {
      for (int x = 0; x < samples.x; ++x) {
        vec3 within = (vec3(x, y, z) + 0.5) / vec3(samples);
        Medium medium = medium_at_place((vec3(cell) + within) / vec3(cell_count), 0.0);
        sum += vec3(weigh(medium, light_weights), weigh(medium, transport_weights), weigh(medium, absorption_weights));
      }
    }
  }
  imageStore(cells, cell, vec4(sum / float(samples.x * samples.y * samples.z), 0.0));
}
