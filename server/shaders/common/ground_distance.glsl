// The distance of the ground along each pixel's ray, from ground/distance.frag. Variant: GROUND (1 if ground may hide
// something).
#include "common/bindings.glsl"

#if GROUND
layout(binding = kGroundDistanceUnit) uniform sampler2D ground_distance;
#endif

// Returns the smaller of `end_m` and the distance of the ground on this pixel's ray. The ground hides everything beyond
// it.
float until_ground(float end_m) {
#if GROUND
  return min(end_m, texelFetch(ground_distance, ivec2(gl_FragCoord.xy), 0).r);
#else
  return end_m;
#endif
}
