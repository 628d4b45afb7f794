// A ball's square on the picture and what it sends to the eye per share of the ray that it takes; four vertices an
// instance, the farthest ball first. The phase functions are looked up once a ball (Man, 4.2): its light comes from one
// direction, and the eye sees it in one.
// Variants: LIGHTS, GROUPS, COLORED, CONSISTENT (as common/phase.glsl has it), PAPER, ISOTROPIC, PARALLEL (view rays).
#include "common/phase.glsl"
#include "metaball/balls.glsl"

layout(std430, binding = 1) readonly buffer Arrived { vec2 arrived[]; };  // of light.comp

uniform int ball_count;
uniform vec3 eye_right;  // unit vectors
uniform vec3 eye_up;
uniform vec3 eye_forward;
uniform vec3 eye_m;
uniform vec2 half_picture;  // the tangents of half the angles of view, or with parallel rays half the size in metres
uniform vec3 towards_light[LIGHTS];
uniform vec3 irradiance[LIGHTS];
uniform vec3 sky_radiance;     // means over the upper and the lower half
uniform vec3 ground_radiance;
uniform float paper_albedo;

flat out vec4 middle_radius;
flat out vec4 source;  // rgb: radiance; a: extinction in the ball's middle
out vec2 position;

// The interval of tangents under which a ball is seen along one axis; `x` and `z` across and forward.
vec2 tangents(float x, float z, float radius) {
  float root = radius * sqrt(max(x * x + z * z - radius * radius, 0.0));
  return vec2(x * z - root, x * z + root) / (z * z - radius * radius);
}

vec3 source_of(Ball ball, uint index, vec3 ray) {
  vec3 radiance = vec3(0.0);
  for (int i = 0; i < LIGHTS; ++i) {
    vec2 light = arrived[uint(i * ball_count) + index];
    float mu = dot(ray, towards_light[i]);
#if PAPER
    float phase = ISOTROPIC == 1 ? 1.0 : 0.75 * (1.0 + mu * mu);  // eq. 25
    radiance += irradiance[i] * (paper_albedo * phase * light.x / kFourPi);
#else
    vec3 scattered = ball.tint.rgb * light.y;
#if ISOTROPIC
    scattered += ball.tint.rgb * (light.x / kFourPi);
#else
    for (int group = 0; group < GROUPS; ++group) {
      scattered += phase_term(group, mu) * (ball.scattering[group / 4][group % 4] * light.x);
    }
#endif
    radiance += irradiance[i] * scattered;
#endif
  }
#if !PAPER
  float sky = arrived[uint(LIGHTS * ball_count) + index].x;
  radiance += ball.tint.rgb * mix(ground_radiance, sky_radiance, sky);
#endif
  return radiance;
}

void main() {
  uint index = order[gl_InstanceID];
  Ball ball = balls[index];
  vec3 off_m = ball.middle_radius.xyz - eye_m;
  float radius_m = ball.middle_radius.w;
  vec3 place = vec3(dot(off_m, eye_right), dot(off_m, eye_up), dot(off_m, eye_forward));
#if PARALLEL
  vec3 ray = eye_forward;
  vec2 low = (place.xy - radius_m) / half_picture;
  vec2 high = (place.xy + radius_m) / half_picture;
#else
  vec3 ray = normalize(off_m);
  vec2 low = vec2(-1.0);
  vec2 high = vec2(1.0);
  if (place.z > 1.001 * radius_m) {
    vec2 across = tangents(place.x, place.z, radius_m) / half_picture.x;
    vec2 upwards = tangents(place.y, place.z, radius_m) / half_picture.y;
    low = vec2(across.x, upwards.x);
    high = vec2(across.y, upwards.y);
  } else if (place.z < -radius_m) {
    high = low;  // behind the eye
  }
#endif
  low = clamp(low, -1.0, 1.0);
  high = clamp(high, -1.0, 1.0);
  position = vec2((gl_VertexID & 1) == 0 ? low.x : high.x, (gl_VertexID & 2) == 0 ? low.y : high.y);
  middle_radius = ball.middle_radius;
  source = vec4(source_of(ball, index, ray), ball.optics.x);
  gl_Position = vec4(position, 0.0, 1.0);
}
