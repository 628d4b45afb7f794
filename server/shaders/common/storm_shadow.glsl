// The storm's shadow, with one texel for each sun ray through the storm's box (Ground::BindShadow).
// Two moments store where along the ray the storm removes light. The loss of light counts as
// uniform over an interval with this mean and variance. At a point inside the box, the shadow is
// the part of this loss that happens in front of the point.
#include "common/bindings.glsl"

// Channel r is the share of sunlight that the storm blocks from places behind it. Channel g is that share times the
// mean place on the ray at which the light is lost. Channel b is that share times the mean square of the place. Places
// range from -1, on the sun's side of the box, to 1.
layout(binding = kGroundShadowUnit) uniform sampler2D shadow;

uniform vec3 shadow_right;  // texture coordinates per metre
uniform vec3 shadow_up;
uniform vec3 shadow_down;  // change of the place on the ray per metre, away from the sun
uniform vec3 shadow_offset;

const float kShortestStretch = 0.01;

vec3 shadow_place(vec3 point_m) {
  return vec3(dot(point_m, shadow_right), dot(point_m, shadow_up), dot(point_m, shadow_down)) + shadow_offset;
}

// Returns the share of sunlight that the storm blocks from a point behind it.
float blocked_behind(vec3 point_m) { return texture(shadow, shadow_place(point_m).xy).r; }

// Returns the share of sunlight that the storm blocks from any point, which may be inside the storm or in front of it.
float blocked_at(vec3 point_m) {
  vec3 place = shadow_place(point_m);
  vec3 lost = texture(shadow, place.xy).rgb;
  if (lost.r < 1e-4) return 0.0;
  float mean = lost.g / lost.r;
  // Half the length of the interval.
  float stretch = max(sqrt(3.0 * max(lost.b / lost.r - mean * mean, 0.0)), kShortestStretch);
  return lost.r * clamp(0.5 + 0.5 * (place.z - mean) / stretch, 0.0, 1.0);
}
