// Phase functions of a medium's groups, looked up by scattering angle. Variants: COLORED (groups have colours),
// CONSISTENT (0 for the transport of Riley et al. 2003 (Vis), "the paper", as in scene/transport.h). GROUPS is the
// number of groups.
#include "common/bindings.glsl"
#include "physics/phase_curve.glsl"

// One row for each group. Columns are spaced by phase_curve_place. Texels hold the values for red, green and blue.
layout(binding = kPhaseCurvesUnit) uniform sampler2D phase_curves;

uniform float phase_cut;  // haversine of the angle within which phase functions are cut
uniform vec2 phase_display[GROUPS];  // offset and slope with which the paper normalises phase functions for display
uniform vec3 group_color[GROUPS];

const float kFourPi = 12.5663706;
const float kPaperWhite = 0.5;  // radiance at the paper's display value 1

// Returns the haversine of the angle between two unit vectors.
float haversine_between(vec3 a, vec3 b) {
  vec3 apart = a - b;
  return 0.25 * dot(apart, apart);
}

// Returns the phase function of a group for red, green and blue, with a mean of 1 over the sphere. It interpolates
// between two fetches, because filtering units round weights to 8 bits, which is visible in steep peaks.
vec3 group_phase(int group, float haversine) {
  int last = textureSize(phase_curves, 0).x - 1;
  float place = phase_curve_place(haversine) * float(last);
  int texel = min(int(place), last - 1);
  vec3 low = texelFetch(phase_curves, ivec2(texel, group), 0).rgb;
  vec3 high = texelFetch(phase_curves, ivec2(texel + 1, group), 0).rgb;
  return mix(low, high, place - float(texel));
}

// Returns the scattered radiance of one group per unit of irradiance and optical depth.
vec3 phase_term(int group, float haversine) {
  vec3 value = group_phase(group, max(haversine, phase_cut));
#if CONSISTENT
  value /= kFourPi;
#else
  value = (phase_display[group].x + phase_display[group].y * log(value)) * kPaperWhite;
#endif
  return value * (COLORED == 1 ? group_color[group] : vec3(1.0));
}
