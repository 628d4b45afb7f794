// What the medium sends to the eye: radiance (rgb) and the share of the background that passes (a). Marches through the
// medium along the view ray; the light comes from arrive.comp. Riley et al. 2003 (Vis), eq. 5 with the phase of
// eq. 18.
// Between two samples extinction, scattering and the square root of the light's optical depth are linear. A segment shows
// what scatters at the middle of the share of light that it takes: exact for a source that is linear in that share,
// whatever the segment's optical depth. Errors against many samples: docs/performance.md.
// DIFFUSION: light scattered many times comes from the diffusion equation (renderers/light_volume/diffuse_light.h). Its
// medium scatters evenly but less, so that the ray loses this light, and what is behind, by similarity-scaled extinction;
// light that is scattered just once keeps its own.
// Variants: GROUND (a ray ends there), GROUPS, COLORED (per-group colours), CONSISTENT (transport), EVEN_ALBEDO (one albedo
// and colour for all), DIFFUSION, TINTED (diffuse light is absorbed or coloured), CORRECTED (by renderers::LightCorrection),
// PLACES (in place of radiance the place where a correction is looked up, in the medium's box).
#include "common/medium.glsl"
#include "common/bricks.glsl"
#include "common/phase.glsl"
#include "common/view.glsl"
#define GLOWS (CONSISTENT && !DIFFUSION)
#include "common/scattered.glsl"
#include "physics/light_transport.glsl"

#if GROUND
layout(binding = 7) uniform sampler2D ground_distance;
#endif
layout(binding = 4) uniform sampler3D arrived;  // of arrive.comp, cell by cell as the medium

uniform vec3 towards_sun;
uniform float step_m;  // between samples
uniform vec4 eye_weights[PLANES];         // texel to the extinction that the eye sees, 1/m

#if DIFFUSION
// Root of the optical depth to the nearest way out; sky seen there, and the x of its net flux (DiffuseLight::SkySeen).
layout(binding = 5) uniform sampler3D ways_out;
layout(binding = 6) uniform sampler3D net_inward;  // of sunlight; fluence from other walls; the y of the sky's net flux

uniform vec4 transport_weights[PLANES];  // texel to similarity-scaled extinction, 1/m
uniform vec3 rest_of_sky;                // mean radiance, without the bright sky around the sun
uniform vec3 rest_of_sky_level;          // its irradiance from above over pi
uniform vec3 diffuse_sunlight;           // irradiance, with that
uniform vec3 from_ground;
#if TINTED
uniform vec4 red_weights[PLANES];  // texel to similarity-scaled scattering, 1/m
uniform vec4 green_weights[PLANES];
uniform vec4 blue_weights[PLANES];
#endif
#endif

#if CORRECTED
layout(binding = 13) uniform sampler3D correction_red;
layout(binding = 14) uniform sampler3D correction_green;
layout(binding = 15) uniform sampler3D correction_blue;
#endif

in vec2 position;
out vec4 radiance_and_transmittance;

const int kMostSamples = 16384;
const float kOnwards = 1.0 + 2.4e-7;  // the next number but one: far away a way is coarser than an end of a leap is near
// Share of the background below which a ray ends. Diffuse light changes little so deep in a cloud: what has been seen stands
// for the rest.
#if DIFFUSION
const float kOpaque = 0.02;
#define SHOWING diffuse_passing
#define SHOWN shown
#else
const float kOpaque = 5e-3;
#define SHOWING passing
#define SHOWN seen
#endif

// What a segment of a ray takes of the light: its share, where on the segment half of that is taken, and the reciprocal
// of the extinction there. Lengths are in steps.
struct Taken {
  float share;
  float at;
  float per_extinction;
};

// From the extinction at the segment's two ends.
Taken taken_on(float segment, float start, float end) {
  float start_depth = segment * start;  // of a segment that is everywhere as at its start
  float rise = segment * (end - start);
  float depth = start_depth + 0.5 * rise;
  float share = depth < 0.01 ? depth * (1.0 - 0.5 * depth) : 1.0 - exp(-depth);
  // Half of what the segment takes is taken before the optical depth from its start reaches -log(1 - share / 2), off by
  // less than 3e-5 of itself:
  float seen_depth =
      share * (0.5 + share * (0.12417144 + share * (0.04885293 + share * (-0.00297576 + share * 0.02306943))));
  // Where that is: the root of a quadratic. There the depth grows by `slope` over the segment.
  float slope = sqrt(max(start_depth * start_depth + 2.0 * rise * seen_depth, 1e-24));
  float reciprocal = 1.0 / (slope * (start_depth + slope));
  return Taken(share, min(2.0 * seen_depth * slope * reciprocal, 1.0),
               segment * (start_depth + slope) * reciprocal);
}

void main() {
  begin_medium();
  vec3 direction = ray_direction(position);
  vec3 origin_m = ray_origin(position);
  vec3 safe = safe_direction(direction);
  MediumRay ray = medium_ray(origin_m, safe);
  vec2 way = way_in_medium(origin_m, safe, 0.0);
  float way_m = max(way.x, 0.0);
  float end_m = way.y;
#if GROUND
  end_m = min(end_m, texelFetch(ground_distance, ivec2(gl_FragCoord.xy), 0).r);
#endif

  // Extinction by the step, not by the metre.
  float per_step = 1.0 / step_m;
  vec4 eye_depths[PLANES] = scaled(eye_weights, step_m);
#if DIFFUSION
  vec4 transport_depths[PLANES] = scaled(transport_weights, step_m);
#if TINTED
  vec4 red_depths[PLANES] = scaled(red_weights, step_m);
  vec4 green_depths[PLANES] = scaled(green_weights, step_m);
  vec4 blue_depths[PLANES] = scaled(blue_weights, step_m);
#endif
#elif GLOWS
  vec4 extinction_depths[PLANES] = scaled(extinction_weights, step_m);
#endif

  float passing = 1.0;
#if DIFFUSION
  float diffuse_passing = 1.0;
  vec3 diffuse_sun = vec3(0.0);  // fluence, by the share of it that is seen
  vec3 diffuse_sky = vec3(0.0);  // by its mean radiance
  vec3 diffuse_level = vec3(0.0);
  vec3 diffuse_all = vec3(0.0);
  float transport_before = 0.0;
  vec4 out_before = vec4(0.0);
  vec4 inward_before = vec4(0.0);
#endif
#if CORRECTED || PLACES
  float shown_all = 0.0;
  float shown_way = 0.0;  // by the share that is seen
#endif
  Scattered scattered = nothing_scattered();

  Medium before;
  for (int plane = 0; plane < PLANES; ++plane) before.plane[plane] = vec4(0.0);
  vec3 through_m = abs(1.0 / (ray.step * vec3(textureSize(medium_plane_0, 0))));
  float cell_m = max(step_m, min(through_m.x, min(through_m.y, through_m.z)));  // the way through a cell
  float extinction_before = -1.0;  // no sample yet
  vec2 light_before = vec2(0.0);

  for (int sample_count = 0; sample_count < kMostSamples && way_m < end_m && SHOWING > kOpaque; ++sample_count) {
    float from_m = way_m;
    float longest_m = step_m;
    while (way_m < end_m) {
      vec3 place = brick_place(ray, way_m);
      uint content = brick_content(ray, place);
      if (content == kThickBrick) break;
      if (content == kThinBrick) {
        // No farther than a sample of thick bricks into the next one, which may be thick.
        longest_m = clamp(empty_way(ray, place, 1u), step_m, cell_m);
        break;
      }
      way_m = max(way_m + empty_way(ray, place, content), way_m * kOnwards);
    }
    // The first sample after a leap only starts a segment.
    float segment_m = way_m > from_m || extinction_before < 0.0 ? 0.0 : min(longest_m, end_m - way_m);
    way_m += segment_m;

    vec3 place = medium_place(ray, way_m);
    Medium here = medium_at_place(place);
    vec2 light_here = texture(arrived, place).rg;
    float extinction_here = weigh(here, eye_depths);
    float start = max(extinction_before, 0.0);
    Taken split = taken_on(segment_m * per_step, start, extinction_here);
    float taken = split.share;
    float at = split.at;
    // Beyond a cloud's end there are cells that are given no light.
    bool ends = extinction_here < 1e-3 * extinction_before;
    vec2 light = ends ? light_before : mix(light_before, light_here, at);
    float arriving = exp(-light.r * light.r);
    float seen = passing * taken;
    float per_extinction = seen * split.per_extinction;
#if DIFFUSION
    float transport_here = weigh(here, transport_depths);
    vec4 out_here = texture(ways_out, place);
    vec4 inward_here = texture(net_inward, place);
    Taken diffuse = taken_on(segment_m * per_step, extinction_before < 0.0 ? 0.0 : transport_before, transport_here);
    vec4 ways = mix(out_before, out_here, diffuse.at);
    vec4 inward = mix(inward_before, inward_here, diffuse.at);
    float passed_root = mix(light_before.r, light_here.r, diffuse.at);
    float transport_there = mix(transport_before, transport_here, diffuse.at);
    float exit_depth = ways.x * ways.x;
    float scale = transport_there / max(mix(start, extinction_here, diffuse.at), 1e-30);
    float fluence = diffuse_fluence(exit_depth, passed_root * passed_root, scale * exit_depth, inward.x, inward.y);
    vec2 sky_shares = ways.yz - vec2(ways.w, inward.z) * (3.0 * scale * exit_depth + 2.0);
    sky_shares *= clamp(sky_shares.x + sky_shares.y, 0.0, 1.0) / max(sky_shares.x + sky_shares.y, 1e-6);
    float passed_depth = passed_root * passed_root;
    fluence += forward_fluence(exit_depth, passed_depth, scale * passed_depth);
    float shown = diffuse_passing * diffuse.share;
#if TINTED
    vec3 tint = mix(vec3(weigh(before, red_depths), weigh(before, green_depths), weigh(before, blue_depths)),
                    vec3(weigh(here, red_depths), weigh(here, green_depths), weigh(here, blue_depths)), diffuse.at) /
                max(transport_there, 1e-30);
#else
    const vec3 tint = vec3(1.0);
#endif
    diffuse_sun += (shown * fluence) * tint;
    diffuse_level += (shown * sky_shares.x) * tint;
    diffuse_sky += (shown * sky_shares.y) * tint;
    diffuse_all += shown * tint;
    diffuse_passing *= 1.0 - diffuse.share;
    transport_before = transport_here;
    out_before = out_here;
    inward_before = inward_here;
#endif
    Medium between;
    for (int plane = 0; plane < PLANES; ++plane) between.plane[plane] = mix(before.plane[plane], here.plane[plane], at);
    add_direct(scattered, between, per_extinction * arriving);
#if GLOWS
    add_isotropic(scattered, between, extinction_depths, seen, light.g);
#endif
#if CORRECTED || PLACES
    shown_all += SHOWN;
    shown_way += SHOWN * (way_m - 0.5 * segment_m);
#endif
    passing *= 1.0 - taken;
    before = here;
    extinction_before = extinction_here;
    light_before = light_here;
  }

  vec3 radiance = radiance_of(scattered, step_m, haversine_between(direction, towards_sun));
#if DIFFUSION
  if (diffuse_passing <= kOpaque) {
    float whole = 1.0 / (1.0 - diffuse_passing);
    diffuse_sun *= whole;
    diffuse_sky *= whole;
    diffuse_level *= whole;
    diffuse_all *= whole;
    diffuse_passing = 0.0;
  }
  radiance += diffuse_sunlight * diffuse_sun / kFourPi + rest_of_sky * diffuse_sky +
              rest_of_sky_level * diffuse_level + from_ground * (diffuse_all - diffuse_sky - diffuse_level);
  passing = diffuse_passing;
#endif
#if CORRECTED || PLACES
  vec3 seen_place = (origin_m + direction * (shown_way / max(shown_all, 1e-30)) - medium_low_m) / (medium_high_m - medium_low_m);
#if PLACES
  radiance = seen_place;
#else
  vec4 by = vec4(1.0, direction);
  radiance *= max(vec3(dot(texture(correction_red, seen_place), by), dot(texture(correction_green, seen_place), by),
                       dot(texture(correction_blue, seen_place), by)),
                  vec3(0.0));
#endif
#endif
  radiance_and_transmittance = vec4(radiance, passing);
}
