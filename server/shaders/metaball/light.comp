// The first pass of P. Man's method ("Generating and Real-Time Rendering of Clouds", section 4.1). It propagates one
// light through the balls, beginning with the ball nearest to the light. A work group processes one ball of a level.
// The balls of a level touch no common texel. The work group reads the light buffer under the ball, stores the light
// that arrives at the ball, and splats the ball into the buffer. The buffer never leaves the device.
//
// Variants: PAPER, PASS, DIFFUSE. PAPER is eq. 26 and 27 as printed. Without PAPER, the buffer holds two optical
// depths: that of the light's extinction in r, and the similarity-scaled optical depth in g. A ball of any thickness
// then scatters exactly the light that it removes. PASS 0 splats. PASS 1 runs after all levels and computes multiply
// scattered light, which also depends on the medium behind the ball. With DIFFUSE and PASS 1, the light is the sky
// above and the ground below instead of a beam.
#include "metaball/balls.glsl"
#include "metaball/bindings.glsl"
#include "physics/light_transport.glsl"
#include "physics/wyvill.glsl"

layout(local_size_x = kBallGroupSize) in;
layout(binding = kBallLightImage, rg32f) uniform image2D light;
// Light that arrives at each ball, by light source and ball. x is the arriving share of the beam.
// For diffuse light, x is the share that comes from the sky. y is the mean intensity of multiply
// scattered light, divided by the beam's irradiance. Between the passes, y is the similarity-scaled
// optical depth in front of the ball's centre.
layout(std430, binding = kBallArrivedBinding) buffer Arrived { vec2 arrived[]; };

uniform int first;  // index in `order` of the first ball of this dispatch
uniform int arrived_first;  // index in `arrived` of the first element of this light
uniform vec3 light_right;   // texels per metre
uniform vec3 light_up;
uniform float texels_per_m;
uniform vec2 light_middle;  // centre of the light buffer in texels
uniform float paper_albedo;
uniform float scattered_often;  // 1, or 0 if light that meets a particle is lost

const float kFourPi = 12.5663706;
const float kForwardPhase = 1.5;  // Rayleigh's function in the forward direction, eq. 25

shared vec3 sums[kBallGroupSize];

void main() {
  uint listed = gl_WorkGroupID.x + uint(first);
  uint index = order[listed];
  Ball ball = balls[index];
  float radius_m = ball.middle_radius.w;
  vec2 middle = light_middle + vec2(dot(ball.middle_radius.xyz, light_right), dot(ball.middle_radius.xyz, light_up));
  // Balls smaller than a texel are spread over it.
  float reach = max(radius_m * texels_per_m, 1.0);
  float spread = radius_m * texels_per_m / reach;
  float thinned = spread * spread;
  ivec2 low = max(ivec2(floor(middle - reach)), ivec2(0));
  ivec2 high = min(ivec2(ceil(middle + reach)), imageSize(light) - 1);
  ivec2 size = max(high - low + 1, ivec2(0));
  // Optical depth, to be multiplied by the column in units of the radius.
  float light_depth = ball.optics.y * radius_m * thinned;
  float scaled_depth = ball.optics.z * radius_m * thinned;

  vec3 sum = vec3(0.0);
  for (int i = int(gl_LocalInvocationIndex); i < size.x * size.y; i += kBallGroupSize) {
    ivec2 texel = low + ivec2(i % size.x, i / size.x);
    vec2 off = (vec2(texel) + 0.5 - middle) / reach;
    float s = 1.0 - dot(off, off);
    if (s <= 0.0) continue;
    vec2 before = imageLoad(light, texel).rg;
#if PAPER
    sum += vec3(before.r, 0.0, 1.0);
#elif PASS == 0
    float column = wyvill_column(s);
    // The light that reaches a place in the ball is attenuated by the part of the ball in front of
    // the place. This is the mean along the line of sight to the light.
    float enters = exp(-before.r) * mean_transmittance(column * light_depth);
    sum += column * vec3(enters, before.g + 0.5 * column * scaled_depth, 1.0);
#else
    sum += wyvill_column(s) * vec3(before.g, 0.0, 1.0);
#endif
  }
  sums[gl_LocalInvocationIndex] = sum;
  barrier();
  for (uint half_count = uint(kBallGroupSize) / 2u; half_count > 0u; half_count >>= 1) {
    if (gl_LocalInvocationIndex < half_count) {
      sums[gl_LocalInvocationIndex] += sums[gl_LocalInvocationIndex + half_count];
    }
    barrier();
  }
  vec2 mean = sums[0].z > 0.0 ? sums[0].xy / sums[0].z : vec2(0.0);
  uint slot = uint(arrived_first) + index;

#if PASS == 1
  if (gl_LocalInvocationIndex > 0u) return;
  float total = mean.x;
  float before = min(arrived[slot].y, total);
#if DIFFUSE
  // Both faces are lit, each by its own diffuse light. Between the faces, Eddington's mean intensity is linear.
  arrived[slot] = vec2((total - before + 2.0 / 3.0) / (total + 4.0 / 3.0), 0.0);
#else
  // Diffuse light that leaves a cloud comes from one transport mean free path (2/3 by Eddington) below its surface.
  arrived[slot].y = scattered_often * diffuse_mean_intensity(min(before + 2.0 / 3.0, total), total);
#endif
#else
  if (gl_LocalInvocationIndex == 0u) arrived[slot] = mean;
  for (int i = int(gl_LocalInvocationIndex); i < size.x * size.y; i += kBallGroupSize) {
    ivec2 texel = low + ivec2(i % size.x, i / size.x);
    vec2 off = (vec2(texel) + 0.5 - middle) / reach;
    float s = 1.0 - dot(off, off);
    if (s <= 0.0) continue;
    vec2 before = imageLoad(light, texel).rg;
#if PAPER
    float depth = paper_depth(ball) * wyvill_field(s) * thinned;
    float scattered = paper_albedo * depth * kForwardPhase * mean.x / kFourPi;
    imageStore(light, texel, vec4(scattered + exp(-depth) * before.r, 0.0, 0.0, 0.0));
#else
    float column = wyvill_column(s);
    imageStore(light, texel, vec4(before + column * vec2(light_depth, scaled_depth), 0.0, 0.0));
#endif
  }
#endif
}
