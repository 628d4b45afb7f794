// Draws for each bubble a quadrangle that covers the bubble's silhouette exactly. This is possible because the tangent
// cone from the eye touches the unit ball in a circle. The quadrangle's depth is that of the nearest possible point of
// the bubble minus slack_m, so that hidden bubbles are rejected before they are shaded. In `order`, the farthest bubble
// is first. With the variant FRONT_FIRST, bubbles are drawn in the reverse of this order.
#include "common/view.glsl"
#include "cumulus/bindings.glsl"
#include "cumulus/bubble.glsl"

layout(std430, binding = kBubbleOrderBinding) readonly buffer Order { uint order[]; };

uniform mat4 clip_from_local;
uniform vec4 eye;  // renderers::EyeOf
uniform int last_rank;
uniform int first_bubble;  // first bubble of this draw, in the order of drawing
uniform float per_far;  // 1 divided by the distance that depth 1 stands for
uniform float slack_m;

const float kRounding = 2e-6;

flat out vec4 unit_x;
flat out vec3 unit_y;
flat out vec3 unit_z;
flat out vec3 centre_m;
flat out int index;

void main() {
#if FRONT_FIRST
  index = int(order[last_rank - first_bubble - gl_InstanceID]);
#else
  index = int(order[first_bubble + gl_InstanceID]);
#endif
  Bubble bubble = bubbles[index];
  unit_x = bubble.unit_x;
  unit_y = bubble.unit_y.xyz;
  unit_z = bubble.unit_z.xyz;
  centre_m = bubble.centre_m.xyz;
  vec2 corner = vec2((gl_VertexID & 1) * 2 - 1, (gl_VertexID & 2) - 1);
  // to_eye points from the bubble's middle to the eye, or against the view direction if rays are parallel.
  vec3 to_eye = to_unit(unit_x.xyz, unit_y, unit_z, eye.xyz - centre_m * eye.w);
  if (eye.w == 0.0) to_eye = -to_eye;
  float distance = length(to_eye);
  if (eye.w != 0.0 && distance < 1.001) {  // the eye is inside
    gl_Position = vec4(corner, -1.0, 1.0);
    return;
  }
  vec3 towards = to_eye / distance;
  float sine = eye.w == 0.0 ? 0.0 : 1.0 / distance;
  float radius = sqrt(1.0 - sine * sine) * 1.002;  // radius of the circle, with a margin for rounding
  vec3 right = normalize(cross(towards, abs(towards.z) < 0.7 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0)));
  vec3 up = cross(right, towards);
  vec3 on_unit = sine * towards + radius * (corner.x * right + corner.y * up);
  mat3 local_from_unit = inverse(transpose(mat3(unit_x.xyz, unit_y, unit_z)));
  gl_Position = clip_from_local * vec4(centre_m + local_from_unit * on_unit, 1.0);
  float middle_m = eye.w == 0.0 ? dot(centre_m - ray_origin_m, ray_forward) : length(centre_m - eye.xyz);
  float depth = clamp((middle_m - bubble.unit_y.w - slack_m) * per_far - kRounding, 0.0, 1.0);
  gl_Position.z = (2.0 * depth - 1.0) * gl_Position.w;
}
