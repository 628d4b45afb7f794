// Computes the radiance of the medium (rgb) and the transmittance to the background (a). It marches through the medium
// along the view ray. The light comes from arrive.comp. The method is Riley et al. 2003 (Vis), eq. 5 with the phase of
// eq. 18.
//
// Between two samples, extinction, scattering and the square root of the light's optical depth are linear. A segment's
// source is evaluated where half of the segment's opacity is reached. For a source that is linear in opacity, this is
// exact for any optical depth of the segment. docs/performance.md has the errors relative to many samples.
//
// With DIFFUSION, multiply scattered light and the background are attenuated as described in
// light_volume/diffuse_seen.glsl. Singly scattered light keeps the medium's own extinction. Variants: those of
// renderers::MarchVariant.
#include "common/medium.glsl"
#include "common/bricks.glsl"
#include "common/ground_distance.glsl"
#include "common/phase.glsl"
#include "common/ray_place.glsl"
#include "common/sunlight.glsl"
#include "common/view.glsl"
#define GLOWS (CONSISTENT && !DIFFUSION)
#include "common/scattered.glsl"
#include "light_volume/bindings.glsl"
#include "light_volume/segment.glsl"
#if DIFFUSION
#include "light_volume/diffuse_seen.glsl"
#else
#include "light_volume/no_diffuse.glsl"
#endif
#if CORRECTED
#include "light_volume/correction.glsl"
#endif

// The output of arrive.comp, with one texel for each cell, like the medium.
layout(binding = kArrivedUnit) uniform sampler3D arrived;

uniform vec3 towards_sun;
uniform float step_m;  // maximum distance between samples
// Maximum step near the eye, as the larger of two values: x paths through a cell, and y times the distance.
uniform vec2 near_step;
uniform vec4 eye_weights[PLANES];  // factors from a texel to the extinction along the eye's ray in 1/m

layout(location = 0) out vec4 radiance_and_transmittance;
layout(location = 1) out float opacity_distance_m;  // opacity times the mean distance of what is visible

const int kMaxSamples = 16384;
// Factor that increases a distance by about two floating-point steps. Far from the eye, the margin
// that empty_path adds is smaller than one such step, and the ray would not leave the brick without
// this factor.
const float kOnwards = 1.0 + 2.4e-7;
const bool kDiffusion = DIFFUSION == 1;
const bool kGlows = CONSISTENT == 1 && !kDiffusion;  // samples add multiply scattered light
const float kEndTransmittance = kDiffusion ? 0.02 : kOpaqueTransmittance;  // a ray ends below this transmittance

// A segment is split if its optical depth exceeds kFaceDepth and the transmittance in front of it exceeds kFaceSeen.
const float kFaceDepth = 1.0;
const float kFaceSeen = 0.1;

// Factors that give optical depths per step instead of extinctions per metre.
vec4 eye_depths[PLANES];
vec4 extinction_depths[PLANES];
float per_step;

void begin_march() {
  begin_medium();
  per_step = 1.0 / step_m;
  eye_depths = scaled(eye_weights, step_m);
  extinction_depths = scaled(extinction_weights, step_m);
  begin_diffuse(step_m);
}

struct Sample {
  Medium medium;
  float extinction;  // extinction along the eye's ray, per step; below 0 as long as there is no sample
  vec2 light;  // the two channels written by arrive.comp
  DiffuseSample diffuse;
};

Sample no_sample() {
  Sample none;
  for (int plane = 0; plane < PLANES; ++plane) none.medium.plane[plane] = vec4(0.0);
  none.extinction = -1.0;
  none.light = vec2(0.0);
  none.diffuse = no_diffuse_sample();
  return none;
}

Sample sample_at(vec3 place, float distance_m) {
  Sample here;
  here.medium = medium_at_place(place, distance_m);
  here.extinction = weigh(here.medium, eye_depths);
  here.light = texture(arrived, place).rg;
  here.diffuse = diffuse_at(place, here.medium);
  return here;
}

// Sums over the part of the ray that has been sampled.
struct Seen {
  Scattered scattered;
  float transmittance;  // transmittance for light scattered once
  float shown;  // sum of the segments' visible weights
  float shown_distance_m;  // sum of weight times distance
  DiffuseSeen diffuse;
};

Seen nothing_seen() {
  Seen seen;
  seen.scattered = nothing_scattered();
  seen.transmittance = 1.0;
  seen.shown = seen.shown_distance_m = 0.0;
  seen.diffuse = no_diffuse_seen();
  return seen;
}

// Returns the transmittance to the background.
float background_transmittance(Seen seen) { return kDiffusion ? seen.diffuse.transmittance : seen.transmittance; }

// Advances `distance_m` to the next sample. The step is at most `limit_m` inside bricks, and empty bricks are skipped.
// Returns the length of the segment that ends at the new sample. The length is 0 for the first sample and after a skip,
// because there the sample only starts a segment.
float advance(inout float distance_m, float end_m, MediumRay ray, float cell_m, float limit_m, bool first) {
  float from_m = distance_m;
  float sampled_m = min(min(max(near_step.x * cell_m, near_step.y * distance_m), step_m), limit_m);
  float longest_m = sampled_m;
  while (distance_m < end_m) {
    vec3 place = brick_place(ray, distance_m);
    uint content = brick_content(ray, place);
    if (content == kThickBrick) break;
    if (content == kThinBrick) {
      // The next brick may be thick, so the step may enter it only by the step length of thick bricks.
      longest_m = min(clamp(empty_path(ray, place, 1u), sampled_m, max(sampled_m, cell_m)), limit_m);
      break;
    }
    distance_m = max(distance_m + empty_path(ray, place, content), distance_m * kOnwards);
  }
  float segment_m = distance_m > from_m || first ? 0.0 : min(longest_m, end_m - distance_m);
  distance_m += segment_m;
  return segment_m;
}

// Adds the segment between two samples. `end_m` is the distance of the second sample.
void see_segment(inout Seen seen, Sample before, Sample here, float segment_m, float end_m) {
  float segment = segment_m * per_step;
  float start = max(before.extinction, 0.0);
  Taken taken = taken_on(segment, start, here.extinction);
  // Cells beyond the edge of a cloud hold no light.
  bool ends = here.extinction < 1e-3 * before.extinction;
  vec2 light = ends ? before.light : mix(before.light, here.light, taken.at);
  float shown = seen.transmittance * taken.share;
  Medium between = mixed(before.medium, here.medium, taken.at);
  add_direct(seen.scattered, between, shown * taken.per_extinction * exp(-light.r * light.r));
  if (kGlows) add_isotropic(seen.scattered, between, extinction_depths, shown, light.g);
  seen.transmittance *= 1.0 - taken.share;
  if (kDiffusion) {
    Taken diffuse = taken_on(segment, before.diffuse.transport, here.diffuse.transport);
    shown = see_diffuse(seen.diffuse, diffuse, mixed(before.diffuse, here.diffuse, diffuse.at),
                        mix(before.light.r, here.light.r, diffuse.at), mix(start, here.extinction, diffuse.at));
  }
  seen.shown += shown;
  seen.shown_distance_m += shown * (end_m - 0.5 * segment_m);
}

float mean_distance_m(Seen seen) { return seen.shown_distance_m / max(seen.shown, 1e-30); }

// Returns the mean place of everything visible on the ray, in coordinates from 0 to 1 in the medium's box.
vec3 seen_place(Seen seen, vec3 origin_m, vec3 direction) {
  vec3 place_m = origin_m + direction * mean_distance_m(seen);
  return (place_m - medium_low_m) / (medium_high_m - medium_low_m);
}

// Returns true if a segment lies at the face of a cloud. Such a segment has much of the remaining visible opacity and
// can be made shorter.
bool is_face(Seen seen, Sample before, Sample here, float segment_m, float finest_m) {
  float depth = 0.5 * (max(before.extinction, 0.0) + here.extinction) * segment_m * per_step;
  return depth > kFaceDepth && seen.transmittance > kFaceSeen && segment_m > 1.5 * finest_m;
}

Seen march(MediumRay ray, float distance_m, float end_m) {
  vec3 through_m = abs(1.0 / (ray.step * vec3(textureSize(medium_plane_0, 0))));
  float cell_m = min(through_m.x, min(through_m.y, through_m.z));  // the path through a cell
  float finest_m = near_step.x * cell_m;
  float longest_m = max(step_m, cell_m);
  float limit_m = longest_m;
  Seen seen = nothing_seen();
  Sample before = no_sample();
  for (int i = 0; i < kMaxSamples && distance_m < end_m && background_transmittance(seen) > kEndTransmittance; ++i) {
    float begin_m = distance_m;
    float segment_m = advance(distance_m, end_m, ray, cell_m, limit_m, before.extinction < 0.0);
    Sample here = sample_at(medium_place(ray, distance_m), distance_m);
    if (is_face(seen, before, here, segment_m, finest_m)) {
      distance_m = begin_m;
      limit_m = max(segment_m / 4.0, finest_m);
      continue;
    }
    see_segment(seen, before, here, segment_m, distance_m);
    before = here;
    limit_m = min(1.3 * limit_m, longest_m);  // increases slowly, because behind a gap the next cloud wall is near
  }
  return seen;
}

void main() {
  begin_place();
  begin_march();
  vec3 direction = ray_direction(position);
  vec3 origin_m = ray_origin(position);
  vec3 safe = safe_direction(direction);
  vec2 path = path_in_medium(origin_m, safe, 0.0);
  Seen seen = march(medium_ray(origin_m, safe), max(path.x, 0.0), until_ground(path.y));

  // One height represents everything visible on the ray.
  vec3 sunlight = sunlight_at(origin_m.z + mean_distance_m(seen) * direction.z);
  vec3 radiance = radiance_of(seen.scattered, sunlight, step_m, haversine_between(direction, towards_sun));
  if (kDiffusion) {
    if (seen.diffuse.transmittance <= kEndTransmittance) close_diffuse(seen.diffuse);
    radiance += diffuse_radiance(seen.diffuse, sunlight);
  }
#if CORRECTED
  radiance = corrected(radiance, seen_place(seen, origin_m, direction), direction);
#endif
  radiance_and_transmittance = vec4(radiance, background_transmittance(seen));
  opacity_distance_m = (1.0 - background_transmittance(seen)) * mean_distance_m(seen);
}
