// Computes which share of the air's light the storm's shadow removes. The result is a 3D texture. Its x and y select a
// ray of a coarse picture, and each of its layers stands for a distance from the eye. A layer holds the removed share
// of airlight_before, the light of the air from the eye up to that distance. The first layer is at the distance
// `near_m` and is zero. The last layer holds the removed share of the whole sky's airlight.
//
// Each step along a ray contributes to airlight_before in proportion to the extinction of its air. The removed share of
// this contribution is the removed share of the sunlight and skylight that the step scatters. The removed light
// therefore never exceeds airlight_before. Where the storm adds more light than it blocks, the share is negative. Rays
// continue below the ground, so that shares change smoothly across the picture. Coordinates are metres from the eye.
#include "common/bindings.glsl"
#include "common/sky_hidden.glsl"
#include "common/storm_shadow.glsl"
#include "common/view.glsl"
#include "physics/air.glsl"
#include "physics/sky.glsl"
#include "physics/air_light.glsl"

layout(local_size_x = kLightGroupSide, local_size_y = kLightGroupSide) in;
layout(binding = kAirShadeImage, rgba16f) uniform writeonly image3D shade;
// Light of the air by height. Row 0 is the sunlight, row 1 the mean radiance of the skylight.
layout(binding = kAirLightUnit) uniform sampler2D air_light;

uniform ivec3 shade_size;
uniform mat3 local_from_world;
uniform vec3 towards_sun;
uniform vec3 level_irradiance;  // irradiance of sun and clear sky on level ground
uniform vec3 level_skylight;  // irradiance of the clear sky on level ground
uniform float turbidity;
uniform float altitude_m;
uniform vec2 air_densities;  // densities of air and haze at the eye
uniform float ground_curvature_per_m;
uniform float horizon_sine;
uniform float lowest_air_m;  // lowest height above sea level at which there is air
uniform float near_m;  // distance of the first layer along the rays
uniform float far_m;
uniform float air_light_per_m;  // texture coordinates per metre of height

const float kInversePi = 0.318309886;
const float kBelowGround_m = 4000.0;  // the air continues down to this depth below the ground
const float kSkysEnd_m = 2e6;
// Upper limit of the light that a storm adds to the air, relative to the air's own light. It is needed in the Earth's
// shadow, where the air's own light almost vanishes.
const float kMostAdded = 1.0;

// Returns the mean share of blocked sunlight over several places along the step around a point. With one place for each
// step, the shadow's edge would appear as one edge for each step.
float mean_blocked(vec3 point_m, vec3 step) {
  const int kPlaces = 4;
  float sum = 0.0;
  for (int i = 0; i < kPlaces; ++i) sum += blocked_at(point_m + ((float(i) + 0.5) / float(kPlaces) - 0.5) * step);
  return sum / float(kPlaces);
}

void main() {
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(texel, shade_size.xy))) return;
  vec2 place = (vec2(texel) + 0.5) / vec2(shade_size.xy) * 2.0 - 1.0;
  vec3 origin_m = ray_origin(place);
  vec3 ray = ray_direction(place);
  float sine = (local_from_world * ray).z;
  float mu = dot(ray, towards_sun);
  int steps = shade_size.z - 2;
  float step_m = (far_m - near_m) / float(steps);
  vec2 size = vec2(textureSize(air_light, 0));
  vec3 missing = vec3(0.0);  // in units of airlight_before for air of infinite length
  vec3 air_per_m = air_optical_depth() / kAirScaleHeight_m;
  vec3 haze_per_m = haze_optical_depth(turbidity) / kHazeScaleHeight_m;
  AirPath path = AirPath(altitude_m, sine, ground_curvature_per_m, near_m);
  vec3 depth = depth_of_air(turbidity, air_densities, path);
  float air_phase_here = air_phase(mu);
  float haze_phase_here = kHazeAlbedo * haze_phase(mu);
  vec3 transmittance = exp(-depth);
  imageStore(shade, ivec3(texel, 0), vec4(0.0));
  for (int i = 0; i < steps; ++i) {
    float distance_m = near_m + (float(i) + 0.5) * step_m;
    float height_m = max(height_on_path_m(path, distance_m), lowest_air_m - kBelowGround_m);
    vec3 point_m = origin_m + distance_m * ray;
    vec2 densities = densities_of_air(height_m);
    float column = (height_m * air_light_per_m * (size.x - 1.0) + 0.5) / size.x;
    vec3 sunlight = texture(air_light, vec2(column, 0.25)).rgb;
    vec3 skylight = texture(air_light, vec2(column, 0.75)).rgb;
    StormInSky storm = storm_in_sky(point_m);
    // Towards a place in its shadow, the storm sends the light that passes through it. Towards other places, it sends
    // half of that light, and the light that it reflects.
    float blocked = mean_blocked(point_m, step_m * ray);
    vec3 through = storm.through * level_irradiance;
    vec3 reflected = light_of_faces(storm, towards_sun, level_skylight);
    vec3 of_storm = mix(0.5 * through + reflected, through, blocked) * kInversePi;
    vec3 air = densities.x * air_per_m;
    vec3 haze = densities.y * haze_per_m;
    vec3 of_sun = (air_phase_here * air + haze_phase_here * haze) * sunlight;
    vec3 scattering = air + kHazeAlbedo * haze;
    vec3 lost = blocked * of_sun + scattering * (storm.hidden * skylight - of_storm);
    vec3 share = lost / max(of_sun + scattering * skylight, vec3(1e-20));
    vec3 behind = transmittance * exp(-step_m * (air + haze));
    missing += (transmittance - behind) * max(share, vec3(-kMostAdded));
    transmittance = behind;
    imageStore(shade, ivec3(texel, i + 1), vec4(missing / max(1.0 - transmittance, vec3(1e-6)), 0.0));
  }
  AirPath sky = AirPath(altitude_m, max(sine, horizon_sine), ground_curvature_per_m, kSkysEnd_m);
  vec3 of_sky = 1.0 - exp(-depth_of_air(turbidity, air_densities, sky));
  imageStore(shade, ivec3(texel, steps + 1), vec4(missing / max(of_sky, vec3(1e-6)), 0.0));
}
