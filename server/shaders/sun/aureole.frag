// Adds the sun's disc behind a medium to the linear frame. It also adds the aureole: light that the medium scatters
// within the forward peaks, which are cut off the phase functions (physics/aureole.h). View rays so close to the sun
// take the same path as the sun's light, so only the optical depths along them matter.
//
// Light scattered once within the peaks has the exact phase function of its group. Light scattered more often is the
// weighted mean of the groups' tables (`aureole`). Each table is read at the optical depth of all groups' peaks
// together, as if its group caused all of this depth. The weight of a group is its share of this depth. Variants: those
// of renderers::MediumVariant, CHOSEN.
#include "common/medium.glsl"
#include "common/bricks.glsl"
#define GROUND 1
#include "common/ground_distance.glsl"
#define COLORED 1
#define CONSISTENT 1
#include "common/phase.glsl"
#include "common/ray_place.glsl"
#include "common/view.glsl"
#include "sun/disc.glsl"

layout(binding = kAureoleUnit) uniform sampler3D aureole;  // physics::Aureole by angle, depth and group

uniform vec3 towards_sun;
uniform vec3 sunlight;    // irradiance at the eye
uniform float step_m;
uniform vec4 scattering_weights[PLANES];  // factors from a texel to scattering in 1/m
uniform float peak_share[GROUPS];  // share of each group's scattering that lies in the cut peak
uniform float aureole_end_rad;
uniform float aureole_max_depth;

out vec4 added;

const float kNoGround_m = 1e8;
const int kMaxSamples = 16384;
const float kOnwards = 1.0 + 2.4e-7;
// A ray ends at this optical depth. The peaks hold at most half of it, so almost no light remains.
const float kOpaqueDepth = 30.0;

// Returns the texel values integrated over the ray, in texel values times metres.
Medium medium_along(vec3 origin_m, vec3 direction) {
  Medium sum;
  for (int plane = 0; plane < PLANES; ++plane) sum.plane[plane] = vec4(0.0);
  vec3 safe = safe_direction(direction);
  MediumRay ray = medium_ray(origin_m, safe);
  vec2 path = path_in_medium(origin_m, safe, 0.0);
  float distance_m = max(path.x, 0.0);
  float end_m = until_ground(path.y);
  for (int i = 0; i < kMaxSamples && distance_m < end_m; ++i) {
    vec3 place = brick_place(ray, distance_m);
    uint content = brick_content(ray, place);
    if (!is_filled(content)) {
      distance_m = max(distance_m + empty_path(ray, place, content), distance_m * kOnwards);
      continue;
    }
    float segment_m = min(step_m, end_m - distance_m);
    float middle_m = distance_m + 0.5 * segment_m;
    Medium here = medium_at_place(medium_place(ray, middle_m), middle_m);
    for (int plane = 0; plane < PLANES; ++plane) sum.plane[plane] += segment_m * here.plane[plane];
    distance_m += segment_m;
    if (weigh(sum, extinction_weights) > kOpaqueDepth) break;
  }
  return sum;
}

vec3 scattered_often(int group, float angle_rad, float peak_depth) {
  vec2 size = vec2(textureSize(aureole, 0).xy);
  vec2 at = sqrt(clamp(vec2(angle_rad / aureole_end_rad, peak_depth / aureole_max_depth), 0.0, 1.0));
  return texture(aureole, vec3((at * (size - 1.0) + 0.5) / size, (float(group) + 0.5) / float(GROUPS))).rgb;
}

void main() {
  begin_place();
  added = vec4(0.0);
  vec3 direction = ray_direction(position);
  float haversine = haversine_between(direction, towards_sun);
  float angle_rad = angle_of(haversine);
  if (angle_rad >= aureole_end_rad) return;
  begin_medium();
  vec3 origin_m = ray_origin(position);
  Medium along = medium_along(origin_m, direction);
  float depth = weigh(along, extinction_weights);
  float scattered[GROUPS];
  float peak_depth = 0.0;
  for (int group = 0; group < GROUPS; ++group) {
    scattered[group] = along.plane[group / 4][group % 4] * scattering_weights[group / 4][group % 4];
    peak_depth += scattered[group] * peak_share[group];
  }
  vec3 once = vec3(0.0);
  vec3 often = vec3(0.0);
  for (int group = 0; group < GROUPS; ++group) {
    vec3 cut = group_phase(group, haversine) - group_phase(group, phase_cut);
    if (peak_share[group] <= 0.0 || haversine >= phase_cut) cut = vec3(0.0);
    once += group_color[group] * max(cut, vec3(0.0)) * (scattered[group] / kFourPi);
    float weight = scattered[group] * peak_share[group] / max(peak_depth, 1e-30);
    if (weight > 0.0) often += group_color[group] * weight * scattered_often(group, angle_rad, peak_depth);
  }
  float disc = until_ground(kNoGround_m) < kNoGround_m ? 0.0 : disc_radiance(angle_rad);
  vec3 radiance = exp(-depth) * (vec3(disc) + once) + exp(peak_depth - depth) * often;
  added = vec4(min(sunlight * radiance, vec3(kMaxRadiance)), 0.0);
}
