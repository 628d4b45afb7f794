// Computes the radiance of each ball per unit of opacity. The phase functions are looked up once for each ball (Man,
// 4.2), because light arrives at a ball from one direction and the eye sees it in one direction. Variants: LIGHTS,
// GROUPS, COLORED, CONSISTENT (see common/phase.glsl), PAPER, ISOTROPIC, PARALLEL (parallel view rays).
#include "common/phase.glsl"
#include "common/sunlight.glsl"
#include "metaball/balls.glsl"
#include "metaball/bindings.glsl"

layout(local_size_x = kBallGroupSize) in;
layout(std430, binding = kBallArrivedBinding) readonly buffer Arrived { vec2 arrived[]; };  // from light.comp
// rgb is the radiance per unit of opacity. a is the extinction at the centre in 1/m, or with PAPER
// the optical depth there.
layout(std430, binding = kBallSourcesBinding) writeonly buffer Sources { vec4 sources[]; };

uniform int ball_count;
uniform vec3 eye_forward;
uniform vec3 eye_m;
uniform vec3 towards_light[LIGHTS];
// Irradiance of each light. The first entry is a factor of the sun's irradiance, which depends on
// height (sunlight_at).
uniform vec3 irradiance[LIGHTS];
uniform vec3 sky_radiance;  // mean radiance of the upper hemisphere; ground_radiance is that of the lower hemisphere
uniform vec3 ground_radiance;
uniform float paper_albedo;

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= uint(ball_count)) return;
  Ball ball = balls[index];
#if PARALLEL
  vec3 ray = eye_forward;
#else
  vec3 off_m = ball.middle_radius.xyz - eye_m;
  vec3 ray = off_m / max(length(off_m), 1e-3);
#endif
  vec3 radiance = vec3(0.0);
  for (int i = 0; i < LIGHTS; ++i) {
    vec2 light = arrived[uint(i * ball_count) + index];
    vec3 arriving = irradiance[i] * (i == 0 ? sunlight_at(ball.middle_radius.z) : vec3(1.0));
#if PAPER
    float mu = dot(ray, towards_light[i]);
    float phase = ISOTROPIC == 1 ? 1.0 : 0.75 * (1.0 + mu * mu);  // eq. 25
    radiance += arriving * (paper_albedo * phase * light.x / kFourPi);
#else
    vec3 scattered = ball.tint.rgb * light.y;
#if ISOTROPIC
    scattered += ball.tint.rgb * (light.x / kFourPi);
#else
    float haversine = haversine_between(ray, towards_light[i]);
    for (int group = 0; group < GROUPS; ++group) {
      scattered += phase_term(group, haversine) * (ball.scattering[group / 4][group % 4] * light.x);
    }
#endif
    radiance += arriving * scattered;
#endif
  }
#if !PAPER
  float sky = arrived[uint(LIGHTS * ball_count) + index].x;
  radiance += ball.tint.rgb * mix(ground_radiance, sky_radiance, sky);
#endif
  sources[index] = vec4(radiance, ball.optics.x);
}
