// Composes the linear frame. It draws the eye buffer in front of sky and ground, all seen through the air. Coordinates
// are metres from the eye. The variants are those of renderers::CompositeVariant.
#include "common/bindings.glsl"
#include "common/box.glsl"
#include "common/ground.glsl"
#include "common/ground_cover.glsl"
#include "common/ray_place.glsl"
#include "common/sky.glsl"
#include "common/storm_shadow.glsl"
#include "common/view.glsl"
#include "physics/air.glsl"
#if SHADED
#include "common/air_shade.glsl"
#include "common/sky_hidden.glsl"
#endif

#if FRONT
layout(binding = kEyeUnit) uniform sampler2D eye;
#endif
#if DISTANCES
// Distance of the eye buffer's content, times its opacity.
layout(binding = kEyeDistanceUnit) uniform sampler2D eye_distance;
#endif

#if CORRECTED
layout(binding = kSkylightFactorUnit) uniform sampler2D skylight_factor;

uniform vec2 skylight_scale;  // texture coordinates per metre
uniform vec2 skylight_offset;
#endif

uniform mat3 local_from_world;  // transforms world directions to east, north and up at the eye
uniform vec3 towards_sun;
uniform vec3 towards_sun_local;
uniform float sky_scale;  // the sun's irradiance times the sky's brightness
uniform float turbidity;
uniform float altitude_m;  // height of the eye above sea level, not below 0
uniform vec2 air_densities;  // densities of air and haze at the eye
uniform vec3 sunlight;           // irradiance on a plane facing the sun
uniform vec3 skylight;           // irradiance on level ground
uniform vec3 box_low_m;  // box of the medium
uniform vec3 box_high_m;

out vec4 rgb_and_opacity;  // alpha is the storm's opacity

const float kJustBelow = 1e-5;
const float kHardlyAnyHaze = 0.01;  // relative to the vertical depth of haze
const float kFarFromTheGround_m = 2e4;

#if COVER == 2
// Returns the radiance of level water. `sky` is the skylight that arrives on level ground. `open` is the share of
// sunlight that the storm lets through.
vec3 water_radiance(vec3 towards_eye, vec3 sky, float open) {
  vec3 sun = sunlight * open;
  towards_eye = normalize(vec3(towards_eye.xy, max(towards_eye.z, 1e-3)));
  vec3 below = water_albedo() / 3.14159265 * (sun * max(towards_sun.z, 0.0) + sky);
  vec3 clear = sky_scale * sky_of_ground(water_reflected(towards_eye), towards_sun);
  // The storm dims the reflected sky by the same factor as the skylight on level ground.
  vec3 reflected = water_reflectance(towards_eye.z) * clear * sky / max(skylight, vec3(1e-9));
  return below + reflected + glint(towards_eye, towards_sun) * sun;
}
#endif

// Returns the ground's radiance by Lambert's law in the light of sun and sky, both shaded by the storm. Terrain shades
// itself only by its slope. Water also reflects the clear sky, but no image of the storm.
vec3 ground_radiance(vec3 point_m, vec3 ray, float distance_m) {
#if RELIEF
  vec3 normal = ground_normal(point_m.xy);
#else
  vec3 normal = vec3(0.0, 0.0, 1.0);
#endif
  float blocked = blocked_behind(point_m);
  float lit = max(dot(normal, towards_sun), 0.0) * (1.0 - blocked);
  vec3 sky = skylight * (0.5 + 0.5 * normal.z);
#if CORRECTED
  sky *= texture(skylight_factor, point_m.xy * skylight_scale + skylight_offset).rgb;
#elif SHADED
  StormInSky storm = storm_in_sky(point_m);
  vec3 through = storm.through * (sunlight * towards_sun.z + skylight);
  vec3 reflected = light_of_faces_on_ground(storm, towards_sun, skylight);
  sky = (1.0 - storm.hidden) * sky + (0.5 + 0.5 * normal.z) * mix(reflected, through, blocked);
#endif
  Cover cover = ground_cover(point_m, ray, distance_m);
  vec3 land = cover.reflectance * (sunlight * lit + sky);
#if COVER == 2
  if (cover.water > 0.0) return mix(land, water_radiance(-ray, sky, 1.0 - blocked), cover.water);
#endif
  return land;
}

// Returns the optical depth of the air in front of a point of the ray. `ray` is a direction in the eye's local frame.
vec3 depth_before(vec3 ray, float distance_m) {
  return depth_of_air(turbidity, air_densities, AirPath(altitude_m, ray.z, ground_curvature_per_m, distance_m));
}

// Returns the clear sky behind a ray. The table's horizon is that of a sphere, but the ground is a
// paraboloid or terrain. The elevation is therefore moved below the table's horizon if the ray
// meets level ground, and above it if the ray meets no ground.
Sky sky_behind(vec3 ray, float ground_m) {
  if (RELIEF == 0 && ground_m > 0.0) ray.z = min(ray.z, horizon_sine - kJustBelow);
  if (ground_m <= 0.0) ray.z = max(ray.z, horizon_sine);
  Sky sky = sky_at(ray, towards_sun_local);
#if RELIEF
  // If the ray of the table's entry ends after hardly any haze, the entry's radiance is almost
  // zero. The air then counts as bright as just above the horizon.
  if (sky.air_mass.y < kHardlyAnyHaze) sky = sky_at(vec3(ray.xy, max(ray.z, horizon_sine)), towards_sun_local);
#endif
  return sky;
}

// Returns the distance at which a ray meets the sphere of the round Earth. The ray must meet it.
float sphere_distance_m(float sine) {
  float from_middle_m = 1.0 / ground_curvature_per_m + altitude_m;
  float nearest_m = -from_middle_m * sine;
  float inside = nearest_m * nearest_m - altitude_m * (altitude_m + 2.0 / ground_curvature_per_m);
  return nearest_m - sqrt(max(inside, 0.0));
}

// Returns the light that the air up to `distance_m` sends to the eye, without the part that the storm's shadow removes.
vec3 shaded_airlight(vec3 airlight, vec3 ray, float distance_m, vec3 sky_radiance, vec3 sky_depth) {
#if SHADED
  vec3 of_shaded = airlight;
  if (distance_m > shade_far_m) of_shaded = airlight_before(exp(-depth_before(ray, shade_far_m)), sky_radiance, sky_depth);
  return max(airlight - air_shade_before(position, distance_m) * of_shaded, vec3(0.0));
#else
  return airlight;
#endif
}

vec3 shaded_sky(vec3 radiance) {
#if SHADED
  return radiance * max(vec3(1.0) - air_shade_of_sky(position), vec3(0.0));
#else
  return radiance;
#endif
}

// Returns the radiance of the ground seen through the air.
vec3 seen_ground(vec3 radiance, vec3 ray, float ground_m, vec3 sky_radiance, vec3 sky_depth) {
#if RELIEF
  vec3 transmittance = exp(-depth_before(ray, ground_m));
  vec3 airlight = airlight_before(transmittance, sky_radiance, sky_depth);
  return transmittance * radiance + shaded_airlight(airlight, ray, ground_m, sky_radiance, sky_depth);
#else
  return exp(-sky_depth) * radiance + shaded_airlight(sky_radiance, ray, ground_m, sky_radiance, sky_depth);
#endif
}

#if FRONT
// Returns the radiance of the eye buffer's content seen through the air, and the transmittance to the background.
vec4 seen_front(vec3 origin_m, vec3 world_ray, vec3 ray, float ground_m, vec3 sky_radiance, vec3 sky_depth) {
  vec4 front = at_pixel(eye);
  float opacity = 1.0 - front.a;
  if (opacity <= 0.0) return front;
#if DISTANCES
  float distance_m = at_pixel(eye_distance).r / opacity;
#else
  // The technique gives no distances. The content counts as being in the middle of the ray's path through the box.
  vec2 path_m = path_through_box(box_low_m, box_high_m, origin_m, safe_direction(world_ray));
  path_m.x = max(path_m.x, 0.0);
  float end_m = ground_m > 0.0 ? min(path_m.y, ground_m) : path_m.y;
  float distance_m = 0.5 * (path_m.x + max(end_m, path_m.x));
#endif
  vec3 transmittance = exp(-depth_before(ray, distance_m));
  vec3 airlight = shaded_airlight(airlight_before(transmittance, sky_radiance, sky_depth), ray, distance_m, sky_radiance, sky_depth);
  return vec4(transmittance * front.rgb + opacity * airlight, front.a);
}
#endif

void main() {
  begin_place();
  vec3 origin_m = ray_origin(position);
  vec3 world_ray = ray_direction(position);
  vec3 ray = local_from_world * world_ray;
  float ground_m = ground_distance_m(origin_m, world_ray);
#if !RELIEF
  // Seen from space, the Earth as a sphere is wider than the paraboloid. Without this correction, a band would be
  // visible between their rims.
  if (altitude_m > kFarFromTheGround_m && ground_m <= 0.0 && ray.z < horizon_sine) ground_m = sphere_distance_m(ray.z);
#endif
  Sky sky = sky_behind(ray, ground_m);
  vec3 sky_radiance = sky_scale * sky.radiance;
  vec3 sky_depth = depth_of_air_mass(turbidity, sky.air_mass);
  vec3 background = ground_m > 0.0 ? seen_ground(ground_radiance(origin_m + ground_m * world_ray, world_ray, ground_m), ray, ground_m,
                                                 sky_radiance, sky_depth)
                                   : shaded_sky(sky_radiance);
#if FRONT
  vec4 front = seen_front(origin_m, world_ray, ray, ground_m, sky_radiance, sky_depth);
  rgb_and_opacity = vec4(front.rgb + front.a * background, 1.0 - front.a);
#else
  rgb_and_opacity = vec4(background, 0.0);
#endif
}
