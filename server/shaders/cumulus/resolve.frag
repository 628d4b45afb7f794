// Combines the cores of the bubbles with the layer in front of them. The result is radiance (rgb) and transmittance
// (a).
#include "cumulus/bindings.glsl"

layout(binding = kCoresUnit) uniform sampler2D cores;
layout(binding = kLayerUnit) uniform sampler2D layer;
layout(binding = kResolvedDepthUnit) uniform sampler2D core_depth;

uniform float far_m;  // distance that depth 1 stands for
uniform float middle_m;  // distance of the surface's middle, used for pixels without a core

layout(location = 0) out vec4 radiance_and_transmittance;
layout(location = 1) out float opacity_distance_m;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 sum = texelFetch(cores, at, 0);
  vec4 front = texelFetch(layer, at, 0);
  // Cores are opaque, so any sum of weights above zero covers the pixel.
  float covered = sum.a > 0.0 ? 1.0 : 0.0;
  vec3 core = sum.a > 0.0 ? sum.rgb / sum.a : vec3(0.0);
  radiance_and_transmittance = vec4(front.rgb + front.a * core, front.a * (1.0 - covered));
  float depth = texelFetch(core_depth, at, 0).r;
  opacity_distance_m = (1.0 - radiance_and_transmittance.a) * (depth < 1.0 ? depth * far_m : middle_m);
}
