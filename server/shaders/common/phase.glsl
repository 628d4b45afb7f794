// What a group of a medium scatters towards the eye of light that turns by an angle. Variants: GROUPS, COLORED (per-group
// colours), CONSISTENT (transport).
#include "physics/phase_functions.glsl"

uniform vec4 phase[GROUPS];
uniform float phase_cut[GROUPS];     // cosine within which the phase function is held
uniform vec2 phase_display[GROUPS];  // offset and slope of the paper's display normalisation
uniform vec3 group_color[GROUPS];

const float kFourPi = 12.5663706;
const float kPaperWhite = 0.5;  // radiance of the paper's display value 1

// Scattered radiance per unit of irradiance and optical depth, of one group; `mu` is the cosine of the scattering angle.
vec3 phase_term(int group, float mu) {
  float value = phase_value(phase[group], min(mu, phase_cut[group]));
#if CONSISTENT
  value /= kFourPi;
#else
  value = (phase_display[group].x + phase_display[group].y * log(value)) * kPaperWhite;
#endif
  return value * (COLORED == 1 ? group_color[group] : vec3(1.0));
}
