// The storm's shadow: one texel for each sun ray through its box (Ground::BindShadow). Where along the ray the storm takes
// the light is kept as two moments, from which a place inside the box gets its share of the shadow as if the light were
// lost evenly over a stretch of that mean and variance.
#include "common/bindings.glsl"

// r: the share of sunlight that the storm keeps from what lies behind it; g: that share times the mean place on the ray at
// which it is lost, b: times the mean of the place's square. Places run from -1, on the sun's side of the box, to 1.
layout(binding = kGroundShadowUnit) uniform sampler2D shadow;

uniform vec3 shadow_right;  // texture coordinates per metre
uniform vec3 shadow_up;
uniform vec3 shadow_down;   // places per metre, away from the sun
uniform vec3 shadow_offset;

const float kShortestStretch = 0.01;

vec3 shadow_place(vec3 point_m) {
  return vec3(dot(point_m, shadow_right), dot(point_m, shadow_up), dot(point_m, shadow_down)) + shadow_offset;
}

// The share of sunlight that the storm keeps from a point behind it.
float blocked_behind(vec3 point_m) { return texture(shadow, shadow_place(point_m).xy).r; }

// The same of a point that may be beside or inside it.
float blocked_at(vec3 point_m) {
  vec3 place = shadow_place(point_m);
  vec3 lost = texture(shadow, place.xy).rgb;
  if (lost.r < 1e-4) return 0.0;
  float mean = lost.g / lost.r;
  float stretch = max(sqrt(3.0 * max(lost.b / lost.r - mean * mean, 0.0)), kShortestStretch);  // half of it
  return lost.r * clamp(0.5 + 0.5 * (place.z - mean) / stretch, 0.0, 1.0);
}
