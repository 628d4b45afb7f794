// Phase functions by formula, one shape for all: P(mu) = (a + b mu^2) / (c + d (1 - mu))^1.5, normalised so that the mean
// over the sphere is 1. mu is the cosine of the scattering angle; 1 - mu keeps the forward peak free of cancellation. Compiles as GLSL and as C++ (physics/optics.h).
#ifdef __cplusplus
#define PHYSICS_FUNCTION inline
#else
#define PHYSICS_FUNCTION
#endif

// Coefficients (a, b, c, d) of Henyey and Greenstein's function with mean cosine g.
PHYSICS_FUNCTION vec4 henyey_greenstein_coefficients(float g) {
  return vec4((1.0f - g) * (1.0f + g), 0.0f, (1.0f - g) * (1.0f - g), 2.0f * g);
}

// Of Cornette and Shanks' function with parameter g (Applied Optics 31, 1992, eq. 8).
PHYSICS_FUNCTION vec4 cornette_shanks_coefficients(float g) {
  float a = 1.5f * (1.0f - g) * (1.0f + g) / (2.0f + g * g);
  return vec4(a, a, (1.0f - g) * (1.0f - g), 2.0f * g);
}

// Of Rayleigh's function, 3/4 (1 + mu^2).
PHYSICS_FUNCTION vec4 rayleigh_coefficients() { return vec4(0.75f, 0.75f, 1.0f, 0.0f); }

// The phase function's value at mu.
PHYSICS_FUNCTION float phase_value(vec4 k, float mu) {
  float base = k.z + k.w * (1.0f - mu);
  return (k.x + k.y * mu * mu) / (base * sqrt(base));
}
