// The light that the storm's shadow takes from the air: for each ray of a coarse picture, the radiance that is missing
// from the eye up to each of a number of distances, a layer each. The first layer is at `near_m` and holds nothing. Rays go
// on below the ground, so that layers change smoothly across the picture. Coordinates are metres from the eye.
#include "common/bindings.glsl"
#include "common/sky_hidden.glsl"
#include "common/storm_shadow.glsl"
#include "common/view.glsl"
#include "physics/air.glsl"
#include "physics/sky.glsl"
#include "physics/air_light.glsl"

layout(local_size_x = kLightGroupSide, local_size_y = kLightGroupSide) in;
layout(binding = kAirShadeImage, rgba16f) uniform writeonly image3D shade;
// By height: row 0, the sunlight; row 1, the mean radiance of light that air has scattered.
layout(binding = kAirLightUnit) uniform sampler2D air_light;

uniform ivec3 shade_size;
uniform mat3 local_from_world;
uniform vec3 towards_sun;
uniform float sky_scale;
uniform vec3 level_irradiance;  // of clear sky and sun on level ground
uniform vec3 level_skylight;    // that of the sky
uniform float turbidity;
uniform float altitude_m;
uniform vec2 air_densities;  // there
uniform float ground_curvature_per_m;
uniform float lowest_air_m;  // above sea level
uniform float near_m;        // distance along the rays
uniform float far_m;
uniform float air_light_per_m;  // texture coordinates of a metre of height

const float kInversePi = 0.318309886;
const float kBelowGround_m = 4000.0;  // to which the air goes on

// Around a point, along a step; with one place for it the shadow's edge would show as many edges as there are steps.
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
  int steps = shade_size.z - 1;
  float step_m = (far_m - near_m) / float(steps);
  vec2 size = vec2(textureSize(air_light, 0));
  vec3 missing = vec3(0.0);
  vec3 air_per_m = air_optical_depth() / kAirScaleHeight_m;
  vec3 haze_per_m = haze_optical_depth(turbidity) / kHazeScaleHeight_m;
  AirPath path = AirPath(altitude_m, sine, ground_curvature_per_m, near_m);
  vec3 depth = depth_of_air(turbidity, air_densities, path);  // before the step
  float air_phase_here = air_phase(mu);
  float haze_phase_here = kHazeAlbedo * haze_phase(mu);
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
    // In its shadow the storm shows what comes through it; elsewhere half of that, and what it reflects.
    float blocked = mean_blocked(point_m, step_m * ray);
    vec3 through = storm.through * level_irradiance;
    vec3 reflected = light_of_faces(storm, towards_sun, level_skylight);
    vec3 of_storm = mix(0.5 * through + reflected, through, blocked) * kInversePi;
    vec3 air = densities.x * air_per_m;
    vec3 haze = densities.y * haze_per_m;
    vec3 lost = blocked * (air_phase_here * air + haze_phase_here * haze) * sunlight +
                (air + kHazeAlbedo * haze) * (storm.hidden * skylight - of_storm);
    vec3 of_step = step_m * (air + haze);
    missing += sky_scale * step_m * exp(-depth - 0.5 * of_step) * lost;
    depth += of_step;
    imageStore(shade, ivec3(texel, i + 1), vec4(missing, 0.0));
  }
}
