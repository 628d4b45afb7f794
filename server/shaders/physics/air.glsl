// Clear air and haze, and what they do to light between an eye and what it sees: both thin out exponentially with height.
// Compiles as GLSL and as C++ (physics/sky.h).
#ifdef __cplusplus
#define PHYSICS_FUNCTION inline
#else
#define PHYSICS_FUNCTION
#endif

const float kAirScaleHeight_m = 8000.0f;
const float kHazeScaleHeight_m = 1200.0f;

// Vertical optical depth of air (Rayleigh scattering) at 650, 550 and 450 nm.
PHYSICS_FUNCTION vec3 air_optical_depth() { return vec3(0.0495f, 0.0973f, 0.2209f); }

// Of haze, as the wavelength to the power -1.3 (Angstrom 1929). Turbidity is the optical depth of air and haze over that
// of air at 550 nm: 1 has no haze, 1.5 is very clear, 2 to 3 fair, 6 and more hazy.
PHYSICS_FUNCTION vec3 haze_optical_depth(float turbidity) {
  return (turbidity - 1.0f) * 0.0973f * vec3(0.805f, 1.0f, 1.298f);
}

// (1 - exp(-x)) / x for any x; below 0.02 its series, whose first dropped term is x^4/120.
PHYSICS_FUNCTION float mean_decay(float x) {
  if (abs(x) < 0.02f) return 1.0f - x * (0.5f - x * (1.0f / 6.0f - x / 24.0f));
  return (1.0f - exp(-x)) / x;
}

// Metres of sea-level air that `distance_m` of a straight way holds, from a height upwards with the given sine. A way
// down must end above the ground.
PHYSICS_FUNCTION float equivalent_m(float scale_height_m, float height_m, float sin_elevation, float distance_m) {
  float climb = distance_m * sin_elevation / scale_height_m;
  // Far below the eye the two exponentials would leave the range of floats one by one, not together.
  if (climb < 0.0f) return distance_m * exp(-height_m / scale_height_m - climb) * mean_decay(-climb);
  return distance_m * exp(-height_m / scale_height_m) * mean_decay(climb);
}

// Optical depth of air and haze on that way.
PHYSICS_FUNCTION vec3 depth_of_air(float turbidity, float height_m, float sin_elevation, float distance_m) {
  return air_optical_depth() *
             (equivalent_m(kAirScaleHeight_m, height_m, sin_elevation, distance_m) / kAirScaleHeight_m) +
         haze_optical_depth(turbidity) *
             (equivalent_m(kHazeScaleHeight_m, height_m, sin_elevation, distance_m) / kHazeScaleHeight_m);
}

// What the eye sees through `distance_m` of air of something that sends `radiance` (already weighted by its opacity) and
// hides `opacity` of what is behind it. `sky` is the radiance of the clear sky in the ray's direction: the air gathers it
// in step with the light that it takes away.
PHYSICS_FUNCTION vec3 through_air(vec3 radiance, float opacity, float distance_m, float eye_height_m,
                                  float sin_elevation, float turbidity, vec3 sky) {
  vec3 passed = exp(-depth_of_air(turbidity, eye_height_m, sin_elevation, distance_m));
  // The sky's own light comes from all the air on the ray, down to the ground or out of the atmosphere.
  const float kEndless_m = 5e5f;
  float end_m = eye_height_m < -sin_elevation * kEndless_m ? eye_height_m / -sin_elevation : kEndless_m;
  vec3 sky_passed = exp(-depth_of_air(turbidity, eye_height_m, sin_elevation, end_m));
  vec3 gathered = min((vec3(1.0f) - passed) / max(vec3(1.0f) - sky_passed, vec3(1e-6f)), vec3(1.0f));
  return passed * radiance + opacity * gathered * sky;
}

// How far level ground is along a ray that starts `height_m` above it and climbs with the given sine; below zero where
// the ray misses it. The ground falls away as d^2 curvature / 2 with the distance d: 0 is a plane. A ray from under the
// ground meets nothing.
PHYSICS_FUNCTION float level_ground_distance_m(float height_m, float sin_elevation, float curvature_per_m) {
  float discriminant =
      sin_elevation * sin_elevation - 2.0f * (1.0f - sin_elevation * sin_elevation) * curvature_per_m * height_m;
  if (height_m <= 0.0f || sin_elevation >= 0.0f || discriminant < 0.0f) return -1.0f;
  return 2.0f * height_m / (sqrt(discriminant) - sin_elevation);
}
