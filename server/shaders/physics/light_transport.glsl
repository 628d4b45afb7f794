// Closed forms of light transport that the renderers share. Compiles as GLSL and as C++ (physics/optics.h).
#ifdef __cplusplus
#define PHYSICS_FUNCTION inline
#else
#define PHYSICS_FUNCTION
#endif

// (1 - exp(-x)) / x for x >= 0, without the cancellation at small x: the mean of exp(-t) over 0..x. Below 0.02 the
// series' first dropped term is x^4/120, under 1.4e-9.
PHYSICS_FUNCTION float mean_transmittance(float x) {
  if (x < 0.02f) return 1.0f - x * (0.5f - x * (1.0f / 6.0f - x / 24.0f));
  return (1.0f - exp(-x)) / x;
}

// The mean over t in 0..1 of exp(-view (1 - t)) exp(-light t): the share of its light that a slice shows when the
// light enters on the side away from the eye.
PHYSICS_FUNCTION float mean_counter_transmittance(float view, float light) {
  return exp(-min(view, light)) * mean_transmittance(abs(view - light));
}

// Where in a slice of optical depth x the eye sees on average: the mean of t in 0..1 weighted by exp(-x t). 1/2 for
// thin slices, 1/x for thick ones. Below 0.1 the series' first dropped term is x^3/720.
PHYSICS_FUNCTION float mean_seen_place(float x) {
  if (x < 0.1f) return 0.5f - x / 12.0f;
  return 1.0f / x - 1.0f / (exp(min(x, 80.0f)) - 1.0f);
}

// Mean intensity of diffuse light, over the sun's irradiance, at optical depth `tau` below the lit face of a layer of
// optical depth `total`, for sunlight at normal incidence: the Eddington solution for isotropic conservative scattering
// with Marshak's boundary conditions (no diffuse light comes in from either side). Optical depths are similarity
// scaled, (1 - omega g) times the real ones. Zero for an empty layer, 2/3 * 3/(4 pi) at the face of an infinite one.
PHYSICS_FUNCTION float diffuse_mean_intensity(float tau, float total) {
  const float kThreeOverFourPi = 0.238732415f;
  float falling = (tau + 2.0f / 3.0f) * (5.0f - exp(-total)) / (3.0f * total + 4.0f);
  return kThreeOverFourPi * max(5.0f / 3.0f - exp(-tau) - falling, 0.0f);
}

// Fluence of diffuse light, over the sun's irradiance, in a semi-infinite cloud with a plane surface and no absorption: at
// optical depth `exit` below the surface, which sunlight has reached through the optical depth `sun_depth`, so that
// exit / sun_depth is the cosine of the sun's angle to the surface's normal. Eddington's solution with Marshak's boundary
// condition.
PHYSICS_FUNCTION float lit_fluence(float exit, float sun_depth) {
  float cosine = exit < sun_depth ? exit / sun_depth : 1.0f;
  return cosine * (2.0f + 3.0f * cosine * (1.0f - exp(-sun_depth)));
}

// Fluence that the diffusion equation misses near the surface: light that has been scattered, at the optical depth
// `sun_depth` from the sun, but has kept its direction, at the similarity-scaled depth `transport_sun_depth`. It shows where
// the sun is low above the surface; the factor is nearer to the reference in 8 of 11 views of five clouds than 1.3
// (docs/decisions/0048-ground-light.md).
PHYSICS_FUNCTION float forward_fluence(float exit, float sun_depth, float transport_sun_depth) {
  float cosine = exit < sun_depth ? exit / sun_depth : 1.0f;
  return 1.6f * (1.0f - cosine * cosine) * (exp(-transport_sun_depth) - exp(-sun_depth));
}

// The same in a cloud onto which other clouds send the fluence `from_walls`, and into which `net_inward` of the sun's
// irradiance flows: light on its path to another face, or, below zero, from one. `transport_exit` is the similarity-scaled
// optical depth below the surface.
PHYSICS_FUNCTION float diffuse_fluence(float exit, float sun_depth, float transport_exit, float net_inward, float from_walls) {
  return max(lit_fluence(exit, sun_depth) + from_walls - net_inward * (3.0f * transport_exit + 2.0f), 0.0f);
}
