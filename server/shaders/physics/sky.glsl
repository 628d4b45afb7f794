// The clear sky, stored as a table of its slowly varying parts. Phase functions vary faster and are multiplied in
// afterwards. physics/sky.h computes the table. The file compiles as GLSL and as C++.
#ifdef __cplusplus
#define PHYSICS_FUNCTION inline
#else
#define PHYSICS_FUNCTION
#endif

// Number of cells of one half of the table. The horizontal axis is the azimuth from the sun. The vertical axis is the
// elevation, with equal numbers of rows above and below the horizon. The left half holds the light of air, the right
// half the light of haze without its phase function. The fourth channels hold the ray's air mass of air (left) and of
// haze (right), relative to a vertical column of the whole atmosphere.
const int kSkyAzimuths = 12;
const int kSkyElevations = 64;

// Returns the position of `direction` (z up) in the cells of the left half. Positions are counted from the middle of
// the first cell. The horizon's elevation has the sine `horizon_sine`, which is below 0 for an eye above the ground.
PHYSICS_FUNCTION vec2 sky_cell(vec3 direction, vec3 towards_sun, float horizon_sine) {
  float across = dot(vec2(direction), vec2(towards_sun));
  float most = sqrt(max((1.0f - direction.z * direction.z) * (1.0f - towards_sun.z * towards_sun.z), 1e-12f));
  float azimuth = 0.5f - 0.5f * clamp(across / most, -1.0f, 1.0f);
  // With the square root, most of the rows are near the horizon. No position is between the rows just above and just
  // below the horizon.
  float above = (direction.z - horizon_sine) / (1.0f - horizon_sine);
  float below = (horizon_sine - direction.z) / (1.0f + horizon_sine);
  const float middle = 0.5f * float(kSkyElevations);
  float row = above >= 0.0f ? middle + sqrt(min(above, 1.0f)) * (middle - 1.0f)
                            : (middle - 1.0f) * (1.0f - sqrt(min(below, 1.0f)));
  return vec2(azimuth * float(kSkyAzimuths - 1), row);
}

// Returns the phase function of continental haze: Henyey and Greenstein's function with g = 0.65, divided by 4 pi.
PHYSICS_FUNCTION float haze_phase(float mu) {
  const float g = 0.65f;
  float base = 1.0f + g * g - 2.0f * g * mu;
  return 0.0795774715f * (1.0f - g * g) / (base * sqrt(base));
}
