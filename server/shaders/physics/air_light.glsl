// Light that air and haze scatter towards an eye from a place on its ray, what a storm's shadow takes away.
// Needs physics/air.glsl and physics/sky.glsl. Compiles as GLSL and as C++ (physics/sky.h).
#ifdef __cplusplus
#define PHYSICS_FUNCTION inline
#else
#define PHYSICS_FUNCTION
#endif

// Of the light that haze takes out of a ray, the share that it scatters: single-scattering albedo of continental haze.
const float kHazeAlbedo = 0.95f;

// Scattering coefficients of air and haze, 1/m, where their densities are those.
PHYSICS_FUNCTION vec3 air_scattering_per_m(vec2 densities) {
  return air_optical_depth() * (densities.x / kAirScaleHeight_m);
}

PHYSICS_FUNCTION vec3 haze_scattering_per_m(float turbidity, vec2 densities) {
  return haze_optical_depth(turbidity) * (kHazeAlbedo * densities.y / kHazeScaleHeight_m);
}

// Rayleigh's phase function over 4 pi.
PHYSICS_FUNCTION float air_phase(float mu) { return 0.0596831037f * (1.0f + mu * mu); }

// Radiance per metre that sunlight of irradiance 1 is scattered to, at an angle of cosine `mu`.
PHYSICS_FUNCTION vec3 sunlight_scattered_per_m(float turbidity, vec2 densities, float mu) {
  return air_phase(mu) * air_scattering_per_m(densities) +
         haze_phase(mu) * haze_scattering_per_m(turbidity, densities);
}

// The same of even light of radiance 1 from everywhere.
PHYSICS_FUNCTION vec3 skylight_scattered_per_m(float turbidity, vec2 densities) {
  return air_scattering_per_m(densities) + haze_scattering_per_m(turbidity, densities);
}

// Height above sea level at a distance on `path`.
PHYSICS_FUNCTION float height_on_path_m(AirPath path, float distance_m) {
  float bend = path.curvature_per_m * (1.0f - path.sin_elevation * path.sin_elevation);
  return path.height_m + distance_m * (path.sin_elevation + 0.5f * bend * distance_m);
}
