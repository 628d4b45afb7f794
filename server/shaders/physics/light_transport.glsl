// Closed-form solutions of light transport that renderers share. The file compiles as GLSL and as
// C++ (physics/optics.h).
#ifdef __cplusplus
#define PHYSICS_FUNCTION inline
#else
#define PHYSICS_FUNCTION
#endif

// Returns (1 - exp(-x)) / x for x >= 0, without cancellation at small x. It is the mean of exp(-t) for t from 0 to x.
// Below 0.02 a series is used, whose first omitted term is x^4/120, less than 1.4e-9.
PHYSICS_FUNCTION float mean_transmittance(float x) {
  if (x < 0.02f) return 1.0f - x * (0.5f - x * (1.0f / 6.0f - x / 24.0f));
  return (1.0f - exp(-x)) / x;
}

// Returns the mean of exp(-view (1 - t)) exp(-light t) for t from 0 to 1. It is the visible share of a slice's light if
// the light enters on the side away from the eye.
PHYSICS_FUNCTION float mean_counter_transmittance(float view, float light) {
  return exp(-min(view, light)) * mean_transmittance(abs(view - light));
}

// Returns the mean position in a slice of optical depth x that the eye sees. It is the mean of t from 0 to 1, weighted
// by exp(-x t). It is 1/2 for thin slices and 1/x for thick slices. Below 0.1 a series is used, whose first omitted
// term is x^3/720.
PHYSICS_FUNCTION float mean_seen_place(float x) {
  if (x < 0.1f) return 0.5f - x / 12.0f;
  return 1.0f / x - 1.0f / (exp(min(x, 80.0f)) - 1.0f);
}

// Returns the mean intensity of diffuse light divided by the sun's irradiance, for sunlight at normal incidence. The
// place is at the optical depth `tau` below the lit face of a layer of the optical depth `total`. It is the Eddington
// solution for isotropic conservative scattering with Marshak's boundary conditions (no diffuse light enters from
// either side). Optical depths are similarity scaled, which is (1 - omega g) times the actual optical depths. The
// result is zero for an empty layer, and 2/3 * 3/(4 pi) at the face of an infinite layer.
PHYSICS_FUNCTION float diffuse_mean_intensity(float tau, float total) {
  const float kThreeOverFourPi = 0.238732415f;
  float falling = (tau + 2.0f / 3.0f) * (5.0f - exp(-total)) / (3.0f * total + 4.0f);
  return kThreeOverFourPi * max(5.0f / 3.0f - exp(-tau) - falling, 0.0f);
}

// Returns the fluence of diffuse light divided by the sun's irradiance, in a semi-infinite cloud with a plane surface
// and no absorption. The place is at the optical depth `exit` below the surface. Sunlight has reached it through the
// optical depth `sun_depth`, so exit / sun_depth is the cosine of the sun's angle to the surface's normal. It is
// Eddington's solution with Marshak's boundary condition.
PHYSICS_FUNCTION float lit_fluence(float exit, float sun_depth) {
  float cosine = exit < sun_depth ? exit / sun_depth : 1.0f;
  return cosine * (2.0f + 3.0f * cosine * (1.0f - exp(-sun_depth)));
}

// Returns fluence near the surface that the diffusion equation omits. It is light that has been
// scattered but has kept its direction. The place is at the optical depth `sun_depth` from the sun.
// Its similarity-scaled depth is `transport_sun_depth`. The light is visible where the sun is low
// above the surface. A factor of 1.6 is closer to the reference than 1.3 in 8 of 11 views of five
// clouds (docs/decisions/0048-ground-light.md).
PHYSICS_FUNCTION float forward_fluence(float exit, float sun_depth, float transport_sun_depth) {
  float cosine = exit < sun_depth ? exit / sun_depth : 1.0f;
  return 1.6f * (1.0f - cosine * cosine) * (exp(-transport_sun_depth) - exp(-sun_depth));
}

// Returns the fluence in a cloud. `from_walls` is the fluence that other cloud walls send to it. `net_inward` is the
// net flux into the cloud, relative to the sun's irradiance. If the flux is positive, it is light on its path to
// another face. If the flux is negative, it is light that came from another face. `transport_exit` is the
// similarity-scaled optical depth below the surface.
PHYSICS_FUNCTION float diffuse_fluence(float exit, float sun_depth, float transport_exit, float net_inward, float from_walls) {
  return max(lit_fluence(exit, sun_depth) + from_walls - net_inward * (3.0f * transport_exit + 2.0f), 0.0f);
}
