// The position of a scattering angle in a tabulated phase function. The file compiles as GLSL and as C++
// (physics/optics.h).
#ifdef __cplusplus
#define PHYSICS_FUNCTION inline
#else
#define PHYSICS_FUNCTION
#endif

// Returns a position from 0 (forward) to 1 (backward) for the haversine sin^2(t/2) of the scattering angle t. The
// position is the square root of sin(t/2) / (sin(t/2) + cos(t/2)). The spacing is finest in the forward direction.
// Diffraction peaks are a few hundredths of a degree wide there, and the cosine of the angle has no significant digits
// left. Elsewhere the spacing is nearly uniform. The function needs no inverse trigonometric functions.
PHYSICS_FUNCTION float phase_curve_place(float haversine) {
  float forward = sqrt(max(1.0f - haversine, 0.0f));
  float backward = sqrt(max(haversine, 0.0f));
  return sqrt(backward / (forward + backward));
}
