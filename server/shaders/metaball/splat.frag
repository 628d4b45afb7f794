// The second pass (Man, 4.2): the balls over a pixel, composited by eq. 29 from front to back until the pixel is opaque.
// Each tile of the picture has a list of the balls that may lie over it, in that order: the same sum as blending their
// splats from back to front, without reading and writing the picture for each. A ball's optical depth is the integral of
// its field along the ray, from the eye and up to the ground.
// Variants: GROUND (what lies behind it is left out), PAPER (the field's own value is the depth: eq. 12 splatted as it
// is).
#include "common/bindings.glsl"
#include "common/ground_distance.glsl"
#include "common/view.glsl"
#include "metaball/balls.glsl"
#include "physics/light_transport.glsl"
#include "physics/wyvill.glsl"

// Each tile's first place in `order`, row by row, and the end.
layout(std430, binding = kBallTilesBinding) readonly buffer TileStarts { uint tile_starts[]; };
layout(std430, binding = kBallSourcesBinding) readonly buffer Sources { vec4 sources[]; };  // of source.comp

uniform int tile_px;
uniform int tiles_across;

in vec2 position;
layout(location = 0) out vec4 radiance_and_transmittance;
layout(location = 1) out float opacity_distance_m;  // the opacity times the mean distance of what shows

const float kOpaqueTransmittance = 5e-3;  // below which a ray ends, as in light_volume/march.frag

void main() {
  ivec2 tile = ivec2(gl_FragCoord.xy) / tile_px;
  int listed = tile.y * tiles_across + tile.x;
  uint first = tile_starts[listed];
  uint end = tile_starts[listed + 1];
  vec3 ray = ray_direction(position);
  vec3 origin_m = ray_origin(position);
#if GROUND
  float end_m = texelFetch(ground_distance, ivec2(gl_FragCoord.xy), 0).r;
#endif
  vec3 radiance = vec3(0.0);
  float transmittance = 1.0;
  float shown_m = 0.0;
  for (uint i = first; i < end && transmittance > kOpaqueTransmittance; ++i) {
    uint index = order[i];
    vec4 middle_radius = balls[index].middle_radius;
    vec3 off_m = middle_radius.xyz - origin_m;
    float along_m = dot(off_m, ray);
    // The part across the ray first: the square of the whole would drown a small ball that is far away.
    vec3 across_m = off_m - along_m * ray;
    float per_radius = 1.0 / middle_radius.w;
    float s = 1.0 - dot(across_m, across_m) * (per_radius * per_radius);
    if (s <= 0.0) continue;
    vec4 source = sources[index];
    float half_chord = sqrt(s);
    float from = -along_m * per_radius;
    float to = half_chord;
#if GROUND
    to = min(to, (end_m - along_m) * per_radius);
#endif
    if (from >= to || to <= -half_chord) continue;
#if PAPER
    float depth = source.a * wyvill_field(s);
    float taken = depth;  // eq. 26
#else
    float column = from <= -half_chord && to >= half_chord
                       ? wyvill_column(s)
                       : wyvill_column_to(s, to) - wyvill_column_to(s, max(from, -half_chord));
    float depth = source.a * middle_radius.w * max(column, 0.0);
    float taken = depth * mean_transmittance(depth);  // 1 - exp(-depth)
#endif
    radiance += transmittance * taken * source.rgb;
    float passed = exp(-depth);
    shown_m += transmittance * (1.0 - passed) * max(along_m + 0.5 * (max(from, -half_chord) + to) * middle_radius.w, 0.0);
    transmittance *= passed;
  }
  radiance_and_transmittance = vec4(radiance, transmittance);
  opacity_distance_m = shown_m;
}
