// The groups of fields with the same optics, and their phase functions (reference/sampled_phase.h). Scattering angles
// are given as x = 1 - cosine, which stays accurate for small angles. GROUPS is the number of groups.
#include "paths/medium.glsl"

#define GROUP_PLANES ((GROUPS + 3) / 4)

// Optics of a group, either exact or similar.
struct GroupOptics {
  vec4 albedo;  // w: mean albedo over the colours, for choosing the group
  float share;  // extinction in these optics divided by the exact extinction
  float asymmetry;
  // Index in `phases` of the group's first table, or -1 for Henyey and Greenstein's function. The
  // angles, which all tables share, are at the beginning of `phases`.
  int table;
  int colors;  // number of tables: 1 or 3
};
layout(std430, binding = kPathGroupsBinding) readonly buffer Groups { GroupOptics group_optics[]; };
layout(std430, binding = kPathPhasesBinding) readonly buffer Phases { float phases[]; };
#if GROUPS > 1
// Extinction by cell in 1/m, four groups in each texture.
layout(binding = kPathGroupsUnit) uniform sampler3D group_extinctions[GROUP_PLANES];
#endif

const float kPi = 3.14159265;
const int kTableFloats = 3 * kPhaseIntervals + 2;

// Returns the index of the group with which light collides, chosen in proportion to the groups' scattering. `factor`
// makes the choice unbiased. Returns -1 if no group scatters.
int choose_group(vec3 place, float u, bool similar, out float factor) {
  factor = 1.0;
#if GROUPS == 1
  return 0;
#else
  vec3 at = place + vec3(first_cell);
  ivec3 low = ivec3(floor(at));
  vec3 share = at - vec3(low);
  vec4 values[GROUP_PLANES];
  for (int plane = 0; plane < GROUP_PLANES; ++plane) values[plane] = vec4(0.0);
  for (int corner = 0; corner < 8; ++corner) {
    ivec3 step = ivec3(corner & 1, (corner >> 1) & 1, corner >> 2);
    vec3 weights = mix(1.0 - share, share, vec3(step));
    ivec3 cell = clamp(low + step, ivec3(0), cell_count - 1);
    for (int plane = 0; plane < GROUP_PLANES; ++plane) {
      values[plane] += weights.x * weights.y * weights.z * texelFetch(group_extinctions[plane], cell, 0);
    }
  }
  float extinction = 0.0;
  float scattering = 0.0;
  for (int i = 0; i < GROUPS; ++i) {
    GroupOptics optics = group_optics[2 * i + int(similar)];
    float value = values[i / 4][i % 4] * optics.share;
    extinction += value;
    scattering += value * optics.albedo.w;
  }
  float left = u * scattering;
  int chosen = -1;
  for (int i = 0; i < GROUPS; ++i) {
    GroupOptics optics = group_optics[2 * i + int(similar)];
    float value = values[i / 4][i % 4] * optics.share * optics.albedo.w;
    if (value > 0.0 && (chosen < 0 || left > 0.0)) {
      chosen = i;
      left -= value;
    }
  }
  if (chosen >= 0) factor = scattering / (extinction * group_optics[2 * chosen + int(similar)].albedo.w);
  return chosen;
#endif
}

float table_value(int table, int interval, float share) {
  return mix(phases[table + interval], phases[table + interval + 1], share);
}

vec3 phase_value(GroupOptics optics, float x) {
  if (optics.table < 0) {
    float g = optics.asymmetry;
    float base = (1.0 - g) * (1.0 - g) + 2.0 * g * x;
    return vec3((1.0 - g) * (1.0 + g) / (base * sqrt(base)));
  }
  float angle = 2.0 * asin(sqrt(clamp(0.5 * x, 0.0, 1.0)));
  int interval = clamp(int(sqrt(angle / kPi) * float(kPhaseIntervals)), 0, kPhaseIntervals - 1);
  // Devices compute inverse trigonometric functions with limited precision, so the computed interval may be off by one.
  if (x < phases[interval]) interval = max(interval - 1, 0);
  if (x > phases[interval + 1]) interval = min(interval + 1, kPhaseIntervals - 1);
  float share = clamp((x - phases[interval]) / (phases[interval + 1] - phases[interval]), 0.0, 1.0);
  vec3 value = vec3(table_value(optics.table, interval, share));
  if (optics.colors > 1) {
    value.y = table_value(optics.table + kTableFloats, interval, share);
    value.z = table_value(optics.table + 2 * kTableFloats, interval, share);
  }
  return value;
}

// Samples a scattering angle, given as x, from the phase function of `color`. `weight` is, for each colour, the ratio
// of its phase function to the sampled function.
float sample_phase(GroupOptics optics, float u, int color, out vec3 weight) {
  weight = vec3(1.0);
  if (optics.table < 0) {
    float g = optics.asymmetry;
    // The closed form is 0 / 0 at g = 0. For |g| below 1e-3, the first-order expansion in g is exact to 1e-6.
    if (abs(g) < 1e-3) {
      float isotropic = 1.0 - 2.0 * u;
      return clamp(1.0 - isotropic - 1.5 * g * (1.0 - isotropic * isotropic), 0.0, 2.0);
    }
    float root = (1.0 - g * g) / (1.0 + g - 2.0 * g * u);
    return clamp(1.0 - (1.0 + g * g - root * root) / (2.0 * g), 0.0, 2.0);
  }
  int table = optics.table + (optics.colors > 1 ? color : 0) * kTableFloats;
  int cumulative = table + kPhaseIntervals + 1;
  int guide = cumulative + kPhaseIntervals + 1;
  int interval = int(phases[guide + min(int(u * float(kPhaseIntervals)), kPhaseIntervals - 1)]);
  while (interval + 1 < kPhaseIntervals && phases[cumulative + interval + 1] < u) ++interval;
  float low = phases[table + interval];
  float high = phases[table + interval + 1];
  float width = phases[interval + 1] - phases[interval];
  float rest = max(u - phases[cumulative + interval], 0.0);
  // y is the root of low y + (high - low) y^2 / (2 width) = 2 rest. This form of the root avoids cancellation.
  float divisor = low + sqrt(max(low * low + 4.0 * (high - low) * rest / width, 0.0));
  float y = divisor > 0.0 ? clamp(4.0 * rest / divisor, 0.0, width) : 0.0;
  if (optics.colors > 1) {
    float share = y / width;
    vec3 values = vec3(table_value(optics.table, interval, share), table_value(optics.table + kTableFloats, interval, share),
                       table_value(optics.table + 2 * kTableFloats, interval, share));
    weight = values / values[color];
  }
  return phases[interval] + y;
}

// Returns the unit vector at an angle from `direction`, rotated about it by `azimuth` (radians). `x` is 1 minus the
// cosine of the angle.
vec3 deflected(vec3 direction, float x, float azimuth) {
  float side = direction.z < 0.0 ? -1.0 : 1.0;
  float a = -1.0 / (side + direction.z);
  float b = direction.x * direction.y * a;
  vec3 across = vec3(1.0 + side * direction.x * direction.x * a, side * b, -side * direction.x);
  vec3 other = vec3(b, side + direction.y * direction.y * a, -direction.y);
  float sine = sqrt(max(x * (2.0 - x), 0.0));
  return normalize((1.0 - x) * direction + sine * (cos(azimuth) * across + sin(azimuth) * other));
}
