// Wyvill's field function (P. Man, "Generating and Real-Time Rendering of Clouds", eq. 12) without its constant k, and
// its integral along a line. The scan of the paper lost the signs. With the signs, the function is 1 - 22/9 a^2 + 17/9
// a^4 - 4/9 a^6. This equals (5 w^2 + 4 w^3) / 9 with w = 1 - a^2. It is 1 at the centre and 0 at a = r/R = 1. The file
// compiles as GLSL and as C++ (renderers/metaball/wyvill.h).
#ifdef __cplusplus
#define PHYSICS_FUNCTION inline
#else
#define PHYSICS_FUNCTION
#endif

// Returns the field at a place where 1 - (r/R)^2 is `w`.
PHYSICS_FUNCTION float wyvill_field(float w) {
  float inside = max(w, 0.0f);
  return inside * inside * (5.0f + 4.0f * inside) / 9.0f;
}

// Returns the integral of the field along a line, in units of R. The integral begins at the line's point nearest to the
// centre. It ends at the distance `z`, where the line must still be inside the ball. The value `s` is 1 - u^2, where u
// is the line's distance from the centre over R.
PHYSICS_FUNCTION float wyvill_column_to(float s, float z) {
  float square = z * z;
  float second = s * s - square * (2.0f / 3.0f * s - square / 5.0f);
  float third = s * s * s - square * (s * s - square * (3.0f / 5.0f * s - square / 7.0f));
  return z * (5.0f * second + 4.0f * third) / 9.0f;
}

// Returns the integral of the field along the whole line, in units of R. It is 0.99894 for a line through the centre.
PHYSICS_FUNCTION float wyvill_column(float s) {
  float inside = max(s, 0.0f);
  return inside * inside * sqrt(inside) * (16.0f / 27.0f + 128.0f / 315.0f * inside);
}
