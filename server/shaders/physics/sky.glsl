// The clear sky as a table of what varies slowly and phase functions that do not (physics/sky.h computes the table).
// Compiles as GLSL and as C++.
#ifdef __cplusplus
#define PHYSICS_FUNCTION inline
#else
#define PHYSICS_FUNCTION
#endif

// Cells of one half of the table: across, the azimuth from the sun; up, the elevation, as many below the horizon as above.
// The left half holds the light of air, the right half that of haze without its phase function; their fourth channels
// hold how much air and haze the ray passes, in vertical depths of the whole.
const int kSkyAzimuths = 12;
const int kSkyElevations = 64;

// Where in the left half's cells, counted from the middle of the first, the table holds `direction` (z up).
// `horizon_sine` is that of the horizon's elevation, below 0 for an eye above the ground.
PHYSICS_FUNCTION vec2 sky_cell(vec3 direction, vec3 towards_sun, float horizon_sine) {
  float across = dot(vec2(direction), vec2(towards_sun));
  float most = sqrt(max((1.0f - direction.z * direction.z) * (1.0f - towards_sun.z * towards_sun.z), 1e-12f));
  float azimuth = 0.5f - 0.5f * clamp(across / most, -1.0f, 1.0f);
  // The square root gives the horizon most of the cells. Nothing lies between the two rows beside it.
  float above = (direction.z - horizon_sine) / (1.0f - horizon_sine);
  float below = (horizon_sine - direction.z) / (1.0f + horizon_sine);
  const float middle = 0.5f * float(kSkyElevations);
  float row = above >= 0.0f ? middle + sqrt(min(above, 1.0f)) * (middle - 1.0f)
                            : (middle - 1.0f) * (1.0f - sqrt(min(below, 1.0f)));
  return vec2(azimuth * float(kSkyAzimuths - 1), row);
}

// Of continental haze: Henyey and Greenstein's function with g = 0.65, over 4 pi.
PHYSICS_FUNCTION float haze_phase(float mu) {
  const float g = 0.65f;
  float base = 1.0f + g * g - 2.0f * g * mu;
  return 0.0795774715f * (1.0f - g * g) / (base * sqrt(base));
}
