// Linear radiance to 8-bit sRGB, top row first. FILMIC: 1 compresses highlights, 0 clips.
#include "common/bindings.glsl"

layout(binding = kLinearFrameUnit) uniform sampler2D linear_frame;

uniform float exposure;

in vec2 position;
out vec4 display;

vec3 srgb(vec3 linear) {
  return mix(12.92 * linear, 1.055 * pow(max(linear, vec3(1e-6)), vec3(1.0 / 2.4)) - 0.055,
             greaterThan(linear, vec3(0.0031308)));
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  pixel.y = textureSize(linear_frame, 0).y - 1 - pixel.y;
  vec3 exposed = max(texelFetch(linear_frame, pixel, 0).rgb * exposure, vec3(0.0));
#if FILMIC
  exposed = vec3(1.0) - exp(-exposed);
#endif
  vec3 coded = srgb(min(exposed, vec3(1.0)));
  // Half a step of ordered noise, so that a clear sky does not band.
  float noise = fract(52.9829189 * fract(dot(floor(gl_FragCoord.xy), vec2(0.06711056, 0.00583715))));
  display = vec4(coded + (noise - 0.5) / 255.0, 1.0);
}
