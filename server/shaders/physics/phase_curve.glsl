// Where a scattering angle lies in a tabulated phase function. Compiles as GLSL and as C++ (physics/optics.h).
#ifdef __cplusplus
#define PHYSICS_FUNCTION inline
#else
#define PHYSICS_FUNCTION
#endif

// From 0 (straight on) to 1 (straight back) for the haversine of the scattering angle t, sin^2(t/2): the square root of
// sin(t/2) / (sin(t/2) + cos(t/2)). That is finest towards straight on, where diffraction peaks are a few hundredths of a
// degree wide and the cosine of the angle has no digits left, and even enough everywhere else; it takes no inverse
// trigonometry.
PHYSICS_FUNCTION float phase_curve_place(float haversine) {
  float forward = sqrt(max(1.0f - haversine, 0.0f));
  float backward = sqrt(max(haversine, 0.0f));
  return sqrt(backward / (forward + backward));
}
