// Clear air and haze, and their effect on light between an eye and an object. The densities of air
// and haze decrease exponentially with height. The file compiles as GLSL and as C++
// (physics/sky.h).
#ifdef __cplusplus
#define PHYSICS_FUNCTION inline
#else
#define PHYSICS_FUNCTION
#endif

const float kAirScaleHeight_m = 8000.0f;
const float kHazeScaleHeight_m = 1200.0f;

// Returns the vertical optical depth of air (Rayleigh scattering) at 650, 550 and 450 nm.
PHYSICS_FUNCTION vec3 air_optical_depth() { return vec3(0.0495f, 0.0973f, 0.2209f); }

// Returns the vertical optical depth of haze, which is proportional to the wavelength to the power -1.3 (Angstrom
// 1929). Turbidity is the optical depth of air and haze divided by that of air, at 550 nm. A turbidity of 1 has no
// haze, 1.5 is very clear, 2 to 3 is fair, 6 and more is hazy.
PHYSICS_FUNCTION vec3 haze_optical_depth(float turbidity) {
  return (turbidity - 1.0f) * 0.0973f * vec3(0.805f, 1.0f, 1.298f);
}

// Returns the densities of air (x) and haze (y) at a height, relative to their densities at sea level.
PHYSICS_FUNCTION vec2 densities_of_air(float height_m) {
  return exp(-height_m / vec2(kAirScaleHeight_m, kHazeScaleHeight_m));
}

// Returns exp(x^2) erfc(x) for x >= 0 with an error below 6e-4. Abramowitz and Stegun (7.1.13) give a lower and an
// upper bound of this function, which differ only in a constant: 2 or 4 / pi. This function replaces the constant by
// `bound`, which grows from 4 / pi at x = 0 to 2 for large x. The value and the slope at 0 are exact.
PHYSICS_FUNCTION float scaled_erfc(float x) {
  float bound = 2.0f - 0.72676046f / (1.0f + x * (0.848f + x * 0.45f));
  return 1.12837917f / (x + sqrt(x * x + bound));
}

// A straight path above the curved Earth.
struct AirPath {
  float height_m;  // height of the path's start above sea level
  float sin_elevation;  // sine of the elevation at the path's start
  float curvature_per_m;  // curvature of the Earth
  float distance_m;  // length of the path
};

// Returns the amount of air or haze along `path`, as a length in metres at the density of sea level. `density` is the
// relative density at the path's start. The height is quadratic in the distance, so the integral is a difference of
// error functions.
PHYSICS_FUNCTION float equivalent_m(float scale_height_m, float density, AirPath path) {
  // If the curvature were 0, the error functions would give 0 / 0. The minimum, a millionth of the Earth's curvature,
  // is negligible.
  float bend = max(path.curvature_per_m * (1.0f - path.sin_elevation * path.sin_elevation), 1e-13f);
  float per_m = sqrt(0.5f * bend / scale_height_m);
  // Scaled distance of the start from the path's lowest point.
  float low = per_m * path.sin_elevation / bend;
  float high = low + per_m * path.distance_m;
  float climb_m = path.distance_m * (path.sin_elevation + 0.5f * bend * path.distance_m);
  float from = density * scaled_erfc(abs(low));
  float to = exp(-(path.height_m + climb_m) / scale_height_m) * scaled_erfc(abs(high));
  float difference = low >= 0.0f ? from - to : to - from;
  if (low < 0.0f && high > 0.0f) {
    // The lowest point is on the path. The density there is computed from the height, because the density at the start
    // may have rounded to zero.
    float lowest_m = path.height_m - 0.5f * path.sin_elevation * path.sin_elevation / bend;
    difference = 2.0f * exp(-lowest_m / scale_height_m) - from - to;
  }
  return 0.886226925f / per_m * difference;
}

// Returns the optical depth of air and haze. `air_mass` holds the amounts of air (x) and haze (y) relative to those of
// a vertical column of the whole atmosphere.
PHYSICS_FUNCTION vec3 depth_of_air_mass(float turbidity, vec2 air_mass) {
  return air_optical_depth() * air_mass.x + haze_optical_depth(turbidity) * air_mass.y;
}

// Returns the optical depth of air and haze along a straight path. `densities` are the relative densities at its start.
PHYSICS_FUNCTION vec3 depth_of_air(float turbidity, vec2 densities, AirPath path) {
  return depth_of_air_mass(turbidity,
                           vec2(equivalent_m(kAirScaleHeight_m, densities.x, path) / kAirScaleHeight_m,
                                equivalent_m(kHazeScaleHeight_m, densities.y, path) / kHazeScaleHeight_m));
}

// Returns the light that the air between the eye and an object sends to the eye. `transmittance` is that of this air.
// `sky` and `sky_depth` are the radiance and the optical depth of the clear sky in the same direction, up to the ground
// or to the top of the atmosphere. The air's light is proportional to 1 - transmittance, even if the air's optical
// depth exceeds `sky_depth`.
PHYSICS_FUNCTION vec3 airlight_before(vec3 transmittance, vec3 sky, vec3 sky_depth) {
  return sky * (vec3(1.0f) - transmittance) / max(vec3(1.0f) - exp(-sky_depth), vec3(1e-6f));
}

// Returns the extinction coefficient of air and haze, in 1/m, at the given densities.
PHYSICS_FUNCTION vec3 air_extinction_per_m(float turbidity, vec2 densities) {
  return air_optical_depth() * (densities.x / kAirScaleHeight_m) +
         haze_optical_depth(turbidity) * (densities.y / kHazeScaleHeight_m);
}

// Returns the light that one metre of air adds to airlight_before. `transmittance` is that of the air between this
// metre and the eye.
PHYSICS_FUNCTION vec3 airlight_per_m(vec3 transmittance, vec3 extinction_per_m, vec3 sky, vec3 sky_depth) {
  return sky * transmittance * extinction_per_m / max(vec3(1.0f) - exp(-sky_depth), vec3(1e-6f));
}
