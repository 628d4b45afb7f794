// A water surface roughened by wind. Its facets have normally distributed slopes, with the same distribution in all
// directions (Cox and Munk 1954). Vectors are unit vectors, and z is up. The file compiles as GLSL and as C++
// (physics/water.h).
#ifdef __cplusplus
#define PHYSICS_FUNCTION inline
#else
#define PHYSICS_FUNCTION
#endif

// Twice the variance of the slope in any one direction. The sum of the variances in both directions is 0.003 + 0.00512
// W, where W is the wind speed, here 5 m/s. The constant is also the square of Beckmann's roughness.
const float kWaterSlopes = 0.0286f;

// Returns the reflectance in red, green and blue of deep water without its surface: the light that emerges from clear
// sea.
PHYSICS_FUNCTION vec3 water_albedo() { return vec3(0.006f, 0.019f, 0.038f); }

// Returns the reflectance of a facet for unpolarised light (Schlick 1994, for a refractive index of 1.33).
PHYSICS_FUNCTION float facet_reflectance(float cosine) {
  float away = clamp(1.0f - cosine, 0.0f, 1.0f);
  float squared = away * away;
  return 0.02f + 0.98f * squared * squared * away;
}

// Returns the mean reflectance of the facets that an eye sees. `cosine` is that of the angle between the zenith and the
// direction to the eye. The source is Bruneton et al. 2010, Real-time realistic ocean lighting, eq. 21.
PHYSICS_FUNCTION float water_reflectance(float cosine) {
  float deviation = sqrt(0.5f * kWaterSlopes);
  float away = clamp(1.0f - cosine, 0.0f, 1.0f);
  float power = 5.0f * exp(-2.69f * deviation);
  return 0.02f + 0.98f * exp(power * log(max(away, 1e-6f))) / (1.0f + 22.7f * deviation * sqrt(deviation));
}

// Returns the direction from which the mean visible facet reflects light to the eye. `towards_eye` must point upwards.
// Facets that face the eye have more weight.
PHYSICS_FUNCTION vec3 water_reflected(vec3 towards_eye) {
  float lift = sqrt(towards_eye.z * towards_eye.z + kWaterSlopes);
  return normalize(vec3(-towards_eye.x, -towards_eye.y, lift));
}

// Returns the share of facets that are not hidden by other facets, as seen at an angle from the zenith with this cosine
// (Walter et al. 2007, eq. 27).
PHYSICS_FUNCTION float facets_unhidden(float cosine) {
  float c = clamp(cosine, 1e-3f, 1.0f);
  float a = c / sqrt(max(kWaterSlopes * (1.0f - c * c), 1e-9f));
  return a >= 1.6f ? 1.0f : (3.535f * a + 2.181f * a * a) / (1.0f + 2.276f * a + 2.577f * a * a);
}

// Returns the glint, which is the radiance of the reflected sun. The sun has the irradiance 1 on a plane that faces it.
PHYSICS_FUNCTION float glint(vec3 towards_eye, vec3 towards_sun) {
  if (towards_eye.z <= 0.0f || towards_sun.z <= 0.0f) return 0.0f;
  vec3 facet = normalize(towards_eye + towards_sun);
  float squared = facet.z * facet.z;
  float slope = (1.0f - squared) / squared;
  float facets = exp(-slope / kWaterSlopes) / (3.14159265f * kWaterSlopes * squared * squared);
  float unhidden = facets_unhidden(towards_eye.z) * facets_unhidden(towards_sun.z);
  return 0.25f * facet_reflectance(dot(facet, towards_sun)) * facets * unhidden / max(towards_eye.z, 1e-3f);
}
