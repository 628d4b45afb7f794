// Light scattered towards the eye along a ray, summed by group: phase functions, albedo and colour depend on the ray or
// the group alone, so they are multiplied in after the last sample. Needs common/medium.glsl and common/phase.glsl.
// Variants: GROUPS, COLORED (per-group colours), CONSISTENT (transport), EVEN_ALBEDO (one albedo and colour for all),
// GLOWS (the radiance includes what add_isotropic adds).
uniform vec4 scattering_weights[PLANES];  // texel to scattering, 1/m
uniform float albedo;                     // of every group
uniform vec3 ambient;                     // mean radiance from sky and ground

struct Scattered {
  vec4 direct[PLANES];  // texel values, by the share of the sunlight that arrives and of its light that is seen
#if EVEN_ALBEDO
  float ambient;        // share of the light from all around that is seen; summed, as differences lose thin slices
  float multiple;       // mean intensity of light scattered many times, by the share of it that is seen
#else
  vec4 ambient[PLANES];   // texel values over extinction, by the share of the light from all around that is seen
  vec4 multiple[PLANES];  // the same of light scattered many times
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

// Of a sample of which `seen` of what it sends shows: `mean_intensity` is that of light scattered many times,
// `extinctions` are the weights of a texel's extinction.
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

// The radiance of a ray whose samples' extinctions were by `step_m`, where the sun's irradiance is `sunlight`; `haversine`
// is that of the scattering angle of sunlight.
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
