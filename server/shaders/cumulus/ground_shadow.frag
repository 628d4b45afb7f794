// Computes the surface's shadow on the ground from its depths as seen from the sun, in the format of
// common/storm_shadow.glsl.
#include "cumulus/bindings.glsl"

layout(binding = kSunDepthUnit) uniform sampler2D depth;

uniform vec2 place_of_depth;  // slope and offset of the linear function from depth to the place on the sun ray

in vec2 position;
out vec4 shadow;

const int kAlong = 4;  // number of depth texels for each texel of the shadow, along each side

void main() {
  vec2 size = vec2(textureSize(depth, 0));
  ivec2 low = ivec2((0.5 * position + 0.5) * size) - kAlong / 2;
  vec3 sum = vec3(0.0);
  for (int i = 0; i < kAlong * kAlong; ++i) {
    ivec2 at = clamp(low + ivec2(i % kAlong, i / kAlong), ivec2(0), ivec2(size) - 1);
    float along = texelFetch(depth, at, 0).r;
    float place = along * place_of_depth.x + place_of_depth.y;
    if (along < 1.0) sum += vec3(1.0, place, place * place);
  }
  shadow = vec4(sum / float(kAlong * kAlong), 0.0);
}
