// The cores that lie together and the layer in front of them: radiance, and the share of the background that passes.
#include "common/bindings.glsl"

layout(binding = kCoresUnit) uniform sampler2D cores;
layout(binding = kLayerUnit) uniform sampler2D layer;

out vec4 radiance_and_transmittance;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 sum = texelFetch(cores, at, 0);
  vec4 front = texelFetch(layer, at, 0);
  // Cores are opaque; a weight without a core behind it belongs to no pixel.
  float covered = sum.a > 0.0 ? 1.0 : 0.0;
  vec3 core = sum.a > 0.0 ? sum.rgb / sum.a : vec3(0.0);
  radiance_and_transmittance = vec4(front.rgb + front.a * core, front.a * (1.0 - covered));
}
