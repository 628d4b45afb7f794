// The second pass (Man, 4.2): what one ball sends to the eye (rgb) and the share of what lies behind it that passes (a),
// which blending puts together as eq. 28 and 29 say. The optical depth is the integral of the ball's field along the ray,
// from the eye and up to the ground.
// Variants: GROUND (what lies behind it is left out), PAPER (the field's own value is the depth: eq. 12 splatted as it is).
#include "common/view.glsl"
#include "physics/light_transport.glsl"
#include "physics/wyvill.glsl"

#if GROUND
layout(binding = 7) uniform sampler2D ground_distance;
#endif

flat in vec4 middle_radius;
flat in vec4 source;
in vec2 position;
out vec4 radiance_and_transmittance;

void main() {
  vec3 ray = ray_direction(position);
  vec3 off_m = middle_radius.xyz - ray_origin(position);
  float radius_m = middle_radius.w;
  float along_m = dot(off_m, ray);
  // The part across the ray first: the square of the whole would drown a small ball that is far away.
  vec3 across = (off_m - along_m * ray) / radius_m;
  float s = 1.0 - dot(across, across);
  if (s <= 0.0) discard;
  float half_chord = sqrt(s);
  float from = max(-half_chord, -along_m / radius_m);
  float to = half_chord;
#if GROUND
  to = min(to, (texelFetch(ground_distance, ivec2(gl_FragCoord.xy), 0).r - along_m) / radius_m);
#endif
  if (from >= to) discard;
#if PAPER
  float depth = source.a * wyvill_field(s);
  float taken = depth;  // eq. 26
#else
  float depth = source.a * radius_m * max(wyvill_column_to(s, to) - wyvill_column_to(s, from), 0.0);
  float taken = depth * mean_transmittance(depth);  // 1 - exp(-depth)
#endif
  radiance_and_transmittance = vec4(source.rgb * taken, exp(-depth));
}
