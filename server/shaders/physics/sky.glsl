// Sunlight and a clear sky by single scattering in a flat, homogeneous atmosphere: a gradient that is blue above and
// white at the horizon, warm when the sun is low. Radiance is in units of the sun's irradiance above the atmosphere.
// Compiles as GLSL and as C++ (physics/sky.h).
#ifdef __cplusplus
#define PHYSICS_FUNCTION inline
#else
#define PHYSICS_FUNCTION
#endif

// Vertical optical depth of air (Rayleigh) at 650, 550 and 450 nm, and of a clean continental haze.
PHYSICS_FUNCTION vec3 air_optical_depth() { return vec3(0.0495f, 0.0973f, 0.2209f); }
PHYSICS_FUNCTION vec3 haze_optical_depth() { return vec3(0.018f, 0.021f, 0.025f); }

// Relative air mass towards a direction with the given sine of elevation: Kasten and Young 1989 reaches 38 at the
// horizon; this form agrees within 3 % above 5 degrees and stays finite everywhere.
PHYSICS_FUNCTION float air_mass(float sin_elevation) {
  float s = max(sin_elevation, 0.0f);
  return 1.0f / (s + 0.025f * exp(-11.0f * s));
}

// Share of sunlight that reaches the ground; fades to nothing while the disc sets.
PHYSICS_FUNCTION vec3 sun_transmittance(float sin_elevation) {
  float above = clamp((sin_elevation + 0.0145f) / 0.029f, 0.0f, 1.0f);
  return exp(-(air_optical_depth() + haze_optical_depth()) * air_mass(sin_elevation)) * above;
}

// Radiance of the sky from unit `direction` (z up) with the sun in unit `towards_sun`.
PHYSICS_FUNCTION vec3 sky_radiance(vec3 direction, vec3 towards_sun) {
  const float kFourPi = 12.5663706f;
  // Light scattered more than once, against the first order; from the mean of clear-sky measurements.
  const float kMultipleScattering = 1.6f;
  float mu = dot(direction, towards_sun);
  float rayleigh = 0.75f * (1.0f + mu * mu);
  float g = 0.7f;
  float base = 1.0f + g * g - 2.0f * g * mu;
  float haze = (1.0f - g * g) / (base * sqrt(base));
  vec3 air_depth = air_optical_depth();
  vec3 haze_depth = haze_optical_depth();
  vec3 depth = air_depth + haze_depth;
  vec3 phase = (air_depth * rayleigh + haze_depth * haze) / depth;
  vec3 filled = vec3(1.0f) - exp(-depth * air_mass(direction.z));
  // The air that fills a line of sight is lit through a part of the way to the ground only.
  vec3 sunlight = exp(-depth * 0.25f * air_mass(towards_sun.z));
  // Twilight: the last light leaves the sky when the sun is 12 degrees down.
  float day = clamp((towards_sun.z + 0.208f) / 0.3f, 0.0f, 1.0f);
  return filled * phase * sunlight * (kMultipleScattering * day * day / kFourPi);
}
