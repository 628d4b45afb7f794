// Light scattered towards the eye along a ray, summed by group. Phase functions, albedo and colour depend only on the
// ray or the group, so they are applied after the last sample. This file needs common/medium.glsl and
// common/phase.glsl.
//
// Variants: GROUPS, COLORED (groups have colours), CONSISTENT (consistent transport, scene/transport.h), EVEN_ALBEDO
// (all groups have the same albedo and no colours), GLOWS (the radiance includes the light of add_isotropic).
uniform vec4 scattering_weights[PLANES];  // factors from a texel to scattering in 1/m
uniform float albedo;  // albedo of every group
uniform vec3 ambient;                     // mean radiance from sky and ground

struct Scattered {
  vec4 direct[PLANES];  // texel values times the arriving share of sunlight times the visible share of the sample
#if EVEN_ALBEDO
  // Visible share of the ambient light. It is summed up, because a difference of transmittances would lose thin slices.
  float ambient;
  float multiple;  // mean intensity of multiply scattered light times the visible share
#else
  vec4 ambient[PLANES];  // texel values divided by the extinction, times the visible share of the ambient light
  vec4 multiple[PLANES];  // as `ambient`, for multiply scattered light
#endif
};

Scattered nothing_scattered() {
  Scattered scattered;
  for (int plane = 0; plane < PLANES; ++plane) {
    scattered.direct[plane] = vec4(0.0);
#if !EVEN_ALBEDO
    scattered.ambient[plane] = scattered.multiple[plane] = vec4(0.0);
#endif
  }
#if EVEN_ALBEDO
  scattered.ambient = scattered.multiple = 0.0;
#endif
  return scattered;
}

// Multiplies all sums by `factor`.
void fade(inout Scattered scattered, float factor) {
  for (int plane = 0; plane < PLANES; ++plane) {
    scattered.direct[plane] *= factor;
#if !EVEN_ALBEDO
    scattered.ambient[plane] *= factor;
    scattered.multiple[plane] *= factor;
#endif
  }
#if EVEN_ALBEDO
  scattered.ambient *= factor;
  scattered.multiple *= factor;
#endif
}

void add_direct(inout Scattered scattered, Medium medium, float factor) {
  for (int plane = 0; plane < PLANES; ++plane) scattered.direct[plane] += factor * medium.plane[plane];
}

// Adds a sample of isotropic light. `seen` is the sample's visible share. `mean_intensity` is that of multiply
// scattered light. `extinctions` are the factors from a texel to extinction.
void add_isotropic(inout Scattered scattered, Medium medium, vec4 extinctions[PLANES], float seen, float mean_intensity) {
#if EVEN_ALBEDO
  scattered.ambient += seen;
  scattered.multiple += seen * mean_intensity;
#else
  float per_total = seen / max(weigh(medium, extinctions), 1e-30);
  for (int plane = 0; plane < PLANES; ++plane) {
    scattered.ambient[plane] += per_total * medium.plane[plane];
    scattered.multiple[plane] += (per_total * mean_intensity) * medium.plane[plane];
  }
#endif
}

// Returns the radiance of a ray from its sums. The extinctions in the sums are per `step_m`. `sunlight` is the sun's
// irradiance. `haversine` is that of the scattering angle of sunlight.
vec3 radiance_of(Scattered scattered, vec3 sunlight, float step_m, float haversine) {
  vec3 radiance = vec3(0.0);
  for (int group = 0; group < GROUPS; ++group) {
    int plane = group / 4;
    int channel = group % 4;
    float scattering = scattering_weights[plane][channel] * step_m;
    radiance += sunlight * (scattered.direct[plane][channel] * scattering) * phase_term(group, haversine);
#if GLOWS && !EVEN_ALBEDO
    vec3 isotropic = ambient * scattered.ambient[plane][channel] + sunlight * scattered.multiple[plane][channel];
    radiance += (COLORED == 1 ? group_color[group] : vec3(1.0)) * isotropic * scattering;
#endif
  }
#if GLOWS && EVEN_ALBEDO
  radiance += albedo * (ambient * scattered.ambient + sunlight * scattered.multiple);
#endif
  return radiance;
}
