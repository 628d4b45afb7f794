// The share of sunlight that the surface keeps from what lies behind it, from the sun's depths.
#include "common/bindings.glsl"

layout(binding = kSunDepthUnit) uniform sampler2D depth;

in vec2 position;
out float blocked;

const int kAlong = 4;  // depths a texel along each side

void main() {
  vec2 size = vec2(textureSize(depth, 0));
  ivec2 low = ivec2((0.5 * position + 0.5) * size) - kAlong / 2;
  float sum = 0.0;
  for (int i = 0; i < kAlong * kAlong; ++i) {
    ivec2 at = clamp(low + ivec2(i % kAlong, i / kAlong), ivec2(0), ivec2(size) - 1);
    sum += texelFetch(depth, at, 0).r < 1.0 ? 1.0 : 0.0;
  }
  blocked = sum / float(kAlong * kAlong);
}
