// The ground's cover where a view ray meets it. Coordinates are metres from the eye. Variants: COVER (0 plain, 1 crop
// fields, 2 land use), BORDERS, RINGS.
#include "common/bindings.glsl"
#include "common/ground.glsl"
#include "physics/ground_cover.glsl"
#include "physics/sky.glsl"
#include "physics/water.glsl"

// Radiance divided by irradiance; for land use, this is the value for a reflectance of 1.
uniform vec3 ground_reflectance;

#if COVER != 0 || BORDERS || RINGS
uniform vec2 pixel_width;  // width of a pixel at the eye (x), and its increase per metre of distance (y)
#endif

#if COVER != 0
layout(binding = kGroundGrainUnit) uniform sampler2D fields;  // physics::FieldPattern

uniform vec2 pattern_origin_m;  // position of the eye in the pattern, in metres
uniform float ground_contrast;
#endif

#if COVER == 2
layout(binding = kGroundCoverUnit) uniform sampler2D land;  // volume::LandSurface
layout(binding = kGroundSkyUnit) uniform sampler2D ground_sky_table;

uniform vec2 land_scale;  // texture coordinates per metre
uniform vec2 land_offset;
uniform vec3 land_mean;  // mean reflectance of all land
uniform float land_fades_cells;  // distance beyond the domain's edge at which land fades by a factor e
uniform float coast_cells;  // width of a coast, in cells
#endif

#if BORDERS
layout(binding = kGroundBordersUnit) uniform sampler2D borders;  // volume::BorderMap

uniform vec2 borders_scale;  // texture coordinates per metre
uniform vec2 borders_offset;
uniform float borders_texel_m;
#endif

#if RINGS
uniform vec2 ring_middle_m;
uniform vec2 ring_north;  // unit vector to true north
#endif

struct Cover {
  vec3 reflectance;  // radiance per irradiance
  float water;  // share of the place that is water
};

#if COVER != 0 || BORDERS || RINGS
vec2 footprint_of(vec3 point_m, vec3 ray, float across_m) {
  float grazing = -(ray.z + ground_curvature_per_m * dot(point_m.xy - touch_m, ray.xy));
  return ground_footprint(ray, grazing, across_m);
}
#endif

#if COVER != 0
float grain_at(vec2 place_m, vec2 footprint_m) {
  if (max(footprint_m.x, footprint_m.y) > kCoarsestGrain_m) return 1.0;
  float level = mip_level(footprint_m / kGrainCell_m);
  return grain_factor(textureLod(fields, grain_cell(place_m) / float(kFieldMapCells), level).a, ground_contrast);
}
#endif

#if COVER == 1
Cover cover_of(vec2 place_m, vec2 footprint_m) {
  vec2 footprint = footprint_m / kFieldCell_m;
  vec2 cell = sharp_cell(place_m / kFieldCell_m, footprint);
  vec3 field = textureLod(fields, cell / float(kFieldMapCells), mip_level(footprint)).rgb;
  vec3 relative = field_reflectance(field, pivot(place_m, footprint_m), roads(place_m, footprint_m), ground_contrast);
  return Cover(ground_reflectance * relative * grain_at(place_m, footprint_m), 0.0);
}
#elif COVER == 2
// Returns the cover from the file's land use. Beyond the domain, the coast continues from the domain's edge, and land
// fades to its mean colour (volume/land_surface.h).
Cover cover_of(vec2 place_m, vec2 footprint_m, vec2 from_eye_m) {
  vec2 place = from_eye_m * land_scale + land_offset;
  vec2 cells = vec2(textureSize(land, 0));
  vec2 outside = max(max(-place, place - 1.0), 0.0) * cells;
  vec2 footprint = abs(land_scale) * footprint_m * cells;
  vec4 texel = textureLod(land, place, mip_level(footprint));
  texel.rgb = mix(texel.rgb, land_mean, 1.0 - exp(-max(outside.x, outside.y) / land_fades_cells));
  // The coast is the line where the interpolated share of water is one half.
  float softness = clamp(max(footprint.x, footprint.y), coast_cells, 1.0);
  float water = clamp((texel.a - 0.5) / softness + 0.5, 0.0, 1.0);
  return Cover(ground_reflectance * texel.rgb * grain_at(place_m, footprint_m), water);
}

// Returns the clear sky as seen from the ground.
vec3 sky_of_ground(vec3 direction, vec3 towards_sun) {
  vec2 size = vec2(2 * kSkyAzimuths, kSkyElevations);
  vec2 cell = sky_cell(direction, towards_sun, 0.0) + 0.5;
  vec3 air = texture(ground_sky_table, cell / size).rgb;
  vec3 haze = texture(ground_sky_table, (cell + vec2(kSkyAzimuths, 0.0)) / size).rgb;
  return air + haze * haze_phase(dot(direction, towards_sun));
}
#endif

#if BORDERS || RINGS
// Mixes paint of the given reflectance into the cover. `share` is the share of the ground that the paint covers.
void paint(inout Cover cover, vec3 reflectance, float share) {
  cover.reflectance = mix(cover.reflectance, reflectance / 3.14159265, share);
  cover.water *= 1.0 - share;
}
#endif

// Returns the cover of the ground at a point of the view ray.
Cover ground_cover(vec3 point_m, vec3 ray, float distance_m) {
#if COVER != 0 || BORDERS || RINGS
  float across_m = pixel_width.x + pixel_width.y * distance_m;
  vec2 footprint_m = footprint_of(point_m, ray, across_m);
#endif
#if COVER == 0
  Cover cover = Cover(ground_reflectance, 0.0);
#elif COVER == 1
  Cover cover = cover_of(point_m.xy + pattern_origin_m, footprint_m);
#else
  Cover cover = cover_of(point_m.xy + pattern_origin_m, footprint_m, point_m.xy);
#endif
#if BORDERS
  vec4 nearest = textureLod(borders, point_m.xy * borders_scale + borders_offset, 0.0);
  paint(cover, border_reflectance(), border_paint(nearest, borders_texel_m, footprint_m, across_m));
#endif
#if RINGS
  paint(cover, ring_reflectance(), ring_paint(point_m.xy - ring_middle_m, ring_north, footprint_m, across_m));
#endif
  return cover;
}
