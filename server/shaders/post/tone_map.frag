// Converts linear radiance to sRGB, top row first. With FILMIC 1, the contrast is increased and a
// film curve is applied. With FILMIC 0, values above 1 are clipped. NOISE 1 is for targets of 8
// bits: it adds dither noise, without which they would show bands. NOISE 0 is for targets of 16
// bits.
#include "common/bindings.glsl"

layout(binding = kLinearFrameUnit) uniform sampler2D linear_frame;

uniform vec3 gain;  // exposure times white balance
uniform int mapped_rows;  // number of rows to map, counted from the lowest row
uniform float just_below_white;  // luminance that the change of contrast leaves unchanged

in vec2 position;
out vec4 display;

// The film curve, applied to each colour. Below m it is a toe, which blends m (x / m)^c smoothly
// into y = x. From m to s = m + l (1 - m) it is y = x. Above s it is a shoulder 1 - (1 - s) exp((s
// - x) / (1 - s)), which tends to 1. Source: Uchimura 2017, "HDR theory and practice" (CEDEC), with
// P = a = 1 and b = 0.
vec3 film(vec3 x) {
  const float m = 0.22;
  const float l = 0.75;
  const float c = 1.33;
  const float s = m + l * (1.0 - m);
  vec3 toe = m * pow(x / m, vec3(c));
  vec3 shoulder = 1.0 - (1.0 - s) * exp((s - x) / (1.0 - s));
  return mix(mix(toe, x, smoothstep(0.0, m, x)), shoulder, greaterThan(x, vec3(s)));
}

// Increases the contrast. Photographs have more contrast than their subjects. This compensates for glare and for the
// surroundings in which they are viewed (Bartleson and Breneman 1967 on the contrast of prints and slides). Half of the
// contrast is applied to the luminance, half to each colour. Applied to each colour alone, it would make a blue sky too
// saturated. Applied to the luminance alone, it would make the sky grey.
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
  // Ordered noise of up to half an 8-bit step prevents bands in a clear sky.
  float noise = fract(52.9829189 * fract(dot(floor(gl_FragCoord.xy), vec2(0.06711056, 0.00583715))));
  coded += (noise - 0.5) / 255.0;
#endif
  display = vec4(coded, 1.0);
}
