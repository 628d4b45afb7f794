// Linear radiance to 8-bit sRGB, top row first. FILMIC: 1 is a film's curve, 0 clips.
#include "common/bindings.glsl"

layout(binding = kLinearFrameUnit) uniform sampler2D linear_frame;

uniform vec3 gain;  // exposure times white balance

in vec2 position;
out vec4 display;

// A toe that darkens the dark and a shoulder that keeps highlights apart, by each colour, so that bright light loses its
// colour as on film: Narkowicz 2016, "ACES Filmic Tone Mapping Curve", y = x (2.51 x + 0.03) / (x (2.43 x + 0.59) + 0.14).
vec3 film(vec3 x) { return x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14); }

vec3 srgb(vec3 linear) {
  return mix(12.92 * linear, 1.055 * pow(max(linear, vec3(1e-6)), vec3(1.0 / 2.4)) - 0.055,
             greaterThan(linear, vec3(0.0031308)));
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  pixel.y = textureSize(linear_frame, 0).y - 1 - pixel.y;
  vec3 exposed = clamp(texelFetch(linear_frame, pixel, 0).rgb * gain, vec3(0.0), vec3(1e4));
#if FILMIC
  exposed = film(exposed);
#endif
  vec3 coded = srgb(min(exposed, vec3(1.0)));
  // Half a step of ordered noise, so that a clear sky does not band.
  float noise = fract(52.9829189 * fract(dot(floor(gl_FragCoord.xy), vec2(0.06711056, 0.00583715))));
  display = vec4(coded + (noise - 0.5) / 255.0, 1.0);
}
