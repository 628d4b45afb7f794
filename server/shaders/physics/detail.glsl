// Detail finer than a model's grid at a place. `control` holds the detail that the model allows there. Its component x
// is the profile, which rises from 0 where the surrounding cells are empty to 1 inside a cloud. Its component y is the
// amplitude. If y is positive, it is that of billows. If y is negative, it is that of fibres. If y is 0, the medium
// stays unchanged. A third value of the texel preserves the water of columns of cells. The noise is that of
// physics/detail_tile.h. `faded` (0 to 1) is the share of the noise that is finer than the drawn resolution. The file
// compiles as GLSL and as C++ (physics/detail_tile.h).
#ifdef __cplusplus
#define PHYSICS_FUNCTION inline
#else
#define PHYSICS_FUNCTION
#endif

const float kSurfaceProfile = 0.5f;  // profile at the cloud's surface where the noise has its mean
const float kSurfaceRelief = 0.8f;  // difference between the profiles at the surface's valleys and at its tops
const float kSurfaceWidth = 0.14f;  // width, in the profile, over which the medium thins out
const float kFibreContrast = 0.8f;
const float kMinWarp = 0.4f;  // share of the full displacement in air without turbulence, where it hides the grid

// Returns the factor that preserves the water of a column of cells. A factor of 1 is stored as 128 of 255.
PHYSICS_FUNCTION float detail_column_factor(float texel) { return texel * (255.0f / 128.0f); }

// Returns the factor by which detail multiplies the medium. Billows erode the profile down to a surface, which noise
// moves. The medium is empty outside the surface and unchanged inside it. Fibres change the medium by noise.
PHYSICS_FUNCTION float detail_factor(vec2 control, float noise, float faded) {
  float surface = kSurfaceProfile + kSurfaceRelief * (0.5f - noise);
  float width = kSurfaceWidth + kSurfaceRelief * faded;
  float t = clamp((control.x - surface) / width + 0.5f, 0.0f, 1.0f);
  float billows = t * t * (3.0f - 2.0f * t);
  float fibres = 1.0f + 2.0f * kFibreContrast * (noise - 0.5f);
  return 1.0f + abs(control.y) * ((control.y > 0.0f ? billows : fibres) - 1.0f);
}

// Returns the displacement of the medium as a share of the full displacement. The share is 0 where `occupied` is 0.
// There the surrounding cells are empty, so the medium is not displaced into empty cells.
PHYSICS_FUNCTION float detail_warp_share(float occupied, float amplitude) {
  return occupied * (kMinWarp + (1.0f - kMinWarp) * abs(amplitude));
}
