// The result of a ray through the medium: the radiance that it sees; or that, corrected by traced light; or, where the
// corrector asks what rays to trace, the place that it sees.
// Variants: CORRECTED, PLACES.
#if CORRECTED
#include "light_volume/correction.glsl"
#endif

// `place` is the mean place of what the ray sees, 0 to 1 in the medium's box.
vec3 outcome_of(vec3 radiance, vec3 place, vec3 direction) {
#if PLACES
  return place;
#elif CORRECTED
  return corrected(radiance, place, direction);
#else
  return radiance;
#endif
}
