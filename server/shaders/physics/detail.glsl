// Detail finer than a model's grid, at a place where `control` holds what the model allows. The profile, x, rises from
// 0 where the surrounding cells are empty to 1 inside a cloud. The amplitude, y, is that of billows above zero and that
// of fibres below zero. The medium stays unchanged where it is 0. A third value of the texel preserves the water of
// columns of cells. The noise is that of physics/detail_tile.h. The share of the noise that is finer than the drawn
// resolution is `faded`, 0 to 1. The file compiles as GLSL and as C++ (physics/detail_tile.h).
#ifdef __cplusplus
#define PHYSICS_FUNCTION inline
#else
#define PHYSICS_FUNCTION
#endif

const float kSurfaceProfile = 0.5f;  // profile at the surface if noise is at its mean
const float kSurfaceRelief = 0.8f;  // difference of profiles between the surface's valleys and its tops
const float kSurfaceWidth = 0.14f;  // width over which the medium thins out
const float kFibreContrast = 0.8f;
const float kMinWarp = 0.4f;  // share of the full warp without any turbulence; hides the grid

// Returns the factor of the medium in its column of cells. A factor of 1 is stored as 128 of 255.
PHYSICS_FUNCTION float detail_column_factor(float texel) { return texel * (255.0f / 128.0f); }

// Returns the factor of the medium. Billows erode the profile down to a surface that noise moves. The medium is empty
// outside the surface and unchanged inside.
PHYSICS_FUNCTION float detail_factor(vec2 control, float noise, float faded) {
  float surface = kSurfaceProfile + kSurfaceRelief * (0.5f - noise);
  float width = kSurfaceWidth + kSurfaceRelief * faded;
  float t = clamp((control.x - surface) / width + 0.5f, 0.0f, 1.0f);
  float billows = t * t * (3.0f - 2.0f * t);
  float fibres = 1.0f + 2.0f * kFibreContrast * (noise - 0.5f);
  return 1.0f + abs(control.y) * ((control.y > 0.0f ? billows : fibres) - 1.0f);
}

// Returns the share of the full warp by which the medium is displaced. `occupied` falls to 0 where the surrounding
// cells are empty, so that nothing is displaced to there.
PHYSICS_FUNCTION float detail_warp_share(float occupied, float amplitude) {
  return occupied * (kMinWarp + (1.0f - kMinWarp) * abs(amplitude));
}
