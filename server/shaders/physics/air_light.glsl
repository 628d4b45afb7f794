// Light that air and haze at a place on a ray scatter towards the eye. A storm's shadow removes this light. This file
// needs physics/air.glsl and physics/sky.glsl. It compiles as GLSL and as C++ (physics/sky.h).
#ifdef __cplusplus
#define PHYSICS_FUNCTION inline
#else
#define PHYSICS_FUNCTION
#endif

// Single-scattering albedo of continental haze.
const float kHazeAlbedo = 0.95f;

// Return the scattering coefficients of air and haze, in 1/m, at the given densities.
PHYSICS_FUNCTION vec3 air_scattering_per_m(vec2 densities) {
  return air_optical_depth() * (densities.x / kAirScaleHeight_m);
}

PHYSICS_FUNCTION vec3 haze_scattering_per_m(float turbidity, vec2 densities) {
  return haze_optical_depth(turbidity) * (kHazeAlbedo * densities.y / kHazeScaleHeight_m);
}

// Returns Rayleigh's phase function, whose integral over the sphere is 1.
PHYSICS_FUNCTION float air_phase(float mu) { return 0.0596831037f * (1.0f + mu * mu); }

// Returns the radiance that one metre of air adds by scattering sunlight of irradiance 1. `mu` is the cosine of the
// scattering angle.
PHYSICS_FUNCTION vec3 sunlight_scattered_per_m(float turbidity, vec2 densities, float mu) {
  return air_phase(mu) * air_scattering_per_m(densities) +
         haze_phase(mu) * haze_scattering_per_m(turbidity, densities);
}

// Returns the radiance that one metre of air adds by scattering uniform light of radiance 1 from all directions.
PHYSICS_FUNCTION vec3 skylight_scattered_per_m(float turbidity, vec2 densities) {
  return air_scattering_per_m(densities) + haze_scattering_per_m(turbidity, densities);
}

// Returns the height above sea level at a distance on `path`.
PHYSICS_FUNCTION float height_on_path_m(AirPath path, float distance_m) {
  float bend = path.curvature_per_m * (1.0f - path.sin_elevation * path.sin_elevation);
  return path.height_m + distance_m * (path.sin_elevation + 0.5f * bend * distance_m);
}
