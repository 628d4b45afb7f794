// Converts linear radiance to 8-bit sRGB, top row first. FILMIC: 1 is a film curve, 0 clips. NOISE: 1 adds noise for 8
// bits, which would otherwise show bands, 0 is for higher precision.
#include "common/bindings.glsl"

layout(binding = kLinearFrameUnit) uniform sampler2D linear_frame;

uniform vec3 gain;  // exposure times white balance
uniform int mapped_rows;  // number of rows, from the lowest
uniform float just_below_white;  // luminance that the contrast does not change

in vec2 position;
out vec4 display;

// The film curve, applied to each colour. Below m it is a toe m (x / m)^c, and up to s = m + l (1 - m) it is y = x.
// Above s it is a shoulder 1 - (1 - s) exp((s - x) / (1 - s)) that tends to 1. Source: Uchimura 2017, "HDR theory and
// practice" (CEDEC), with P = a = 1 and b = 0.
vec3 film(vec3 x) {
  const float m = 0.22;
  const float l = 0.75;
  const float c = 1.33;
  const float s = m + l * (1.0 - m);
  vec3 toe = m * pow(x / m, vec3(c));
  vec3 shoulder = 1.0 - (1.0 - s) * exp((s - x) / (1.0 - s));
  return mix(mix(toe, x, smoothstep(0.0, m, x)), shoulder, greaterThan(x, vec3(s)));
}

// Photographs have more contrast than their subjects, to compensate for glare and for the surroundings in which they
// are viewed (Bartleson and Breneman 1967 on the contrast of prints and slides). Half of the contrast is applied by
// luminance, half by each colour. By each colour alone, a blue sky would be too saturated. By luminance alone, it would
// be grey.
vec3 contrasty(vec3 x) {
  const float kContrast = 1.25;
  float luminance = dot(x, vec3(0.2126, 0.7152, 0.0722));
  return x * pow(sqrt(x * luminance) / just_below_white, vec3(kContrast - 1.0));
}

vec3 srgb(vec3 linear) {
  return mix(12.92 * linear, 1.055 * pow(max(linear, vec3(1e-6)), vec3(1.0 / 2.4)) - 0.055,
             greaterThan(linear, vec3(0.0031308)));
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  pixel.y = mapped_rows - 1 - pixel.y;
  vec3 exposed = clamp(texelFetch(linear_frame, pixel, 0).rgb * gain, vec3(0.0), vec3(1e4));
#if FILMIC
  exposed = film(contrasty(exposed));
#endif
  vec3 coded = srgb(min(exposed, vec3(1.0)));
#if NOISE
  // Half a step of ordered noise prevents bands in a clear sky.
  float noise = fract(52.9829189 * fract(dot(floor(gl_FragCoord.xy), vec2(0.06711056, 0.00583715))));
  coded += (noise - 0.5) / 255.0;
#endif
  display = vec4(coded, 1.0);
}
