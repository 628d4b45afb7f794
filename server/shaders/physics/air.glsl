// The air between an eye and what it sees. Needs physics/sky.glsl. Compiles as GLSL and as C++ (physics/sky.h).
#ifdef __cplusplus
#define PHYSICS_FUNCTION inline
#else
#define PHYSICS_FUNCTION
#endif

const float kAirScaleHeight_m = 8000.0f;

// How far level ground is along a ray that starts `height_m` above it and climbs with the given sine; below zero where
// the ray misses it. The ground falls away as d^2 curvature / 2 with the distance d: 0 is a plane. A ray from under the
// ground meets nothing.
PHYSICS_FUNCTION float level_ground_distance_m(float height_m, float sin_elevation, float curvature_per_m) {
  float discriminant =
      sin_elevation * sin_elevation - 2.0f * (1.0f - sin_elevation * sin_elevation) * curvature_per_m * height_m;
  if (height_m <= 0.0f || sin_elevation >= 0.0f || discriminant < 0.0f) return -1.0f;
  return 2.0f * height_m / (sqrt(discriminant) - sin_elevation);
}

// Share of light that passes `distance_m` of air on a way between sea level and `height_m` above it: the way's mean
// air is that of an exponential atmosphere.
PHYSICS_FUNCTION vec3 air_transmittance(float distance_m, float height_m) {
  float heights = max(height_m, 1.0f) / kAirScaleHeight_m;
  float mean_density = (1.0f - exp(-heights)) / heights;
  return exp(-(air_optical_depth() + haze_optical_depth()) * (distance_m * mean_density / kAirScaleHeight_m));
}
