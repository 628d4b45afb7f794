// Detail finer than a model's grid, at a place where `control` says what the model allows: x, the profile, rises from 0 where
// the cells around are empty to 1 inside a cloud; y, the amplitude, is that of billows above zero, of fibres below it, and
// 0 where the medium stays as it is. Noise is that of physics/detail_tile.h. `faded` is the share of the noise that is finer
// than what is drawn, 0 to 1. A third value of the texel keeps what columns of cells hold. Compiles as GLSL and as C++ (physics/detail_tile.h).
#ifdef __cplusplus
#define PHYSICS_FUNCTION inline
#else
#define PHYSICS_FUNCTION
#endif

const float kSurfaceProfile = 0.5f;  // where the surface lies if noise is at its mean
const float kSurfaceRelief = 0.8f;    // profiles between the surface's valleys and its tops
const float kSurfaceWidth = 0.14f;    // on which the medium thins out
const float kFibreContrast = 0.8f;
const float kMinWarp = 0.4f;        // of the full warp, without any turbulence: hides the grid

// Factor of the medium in its column of cells, where 1 is a texel of 128 of 255.
PHYSICS_FUNCTION float detail_column_factor(float texel) { return texel * (255.0f / 128.0f); }

// Factor of the medium. Billows erode the profile up to a surface that noise moves: empty outside, unchanged inside.
PHYSICS_FUNCTION float detail_factor(vec2 control, float noise, float faded) {
  float surface = kSurfaceProfile + kSurfaceRelief * (0.5f - noise);
  float width = kSurfaceWidth + kSurfaceRelief * faded;
  float t = clamp((control.x - surface) / width + 0.5f, 0.0f, 1.0f);
  float billows = t * t * (3.0f - 2.0f * t);
  float fibres = 1.0f + 2.0f * kFibreContrast * (noise - 0.5f);
  return 1.0f + abs(control.y) * ((control.y > 0.0f ? billows : fibres) - 1.0f);
}

// The share of the full warp by which the medium is displaced. `occupied` falls to 0 where the cells around are empty, so that
// nothing is displaced to there.
PHYSICS_FUNCTION float detail_warp_share(float occupied, float amplitude) {
  return occupied * (kMinWarp + (1.0f - kMinWarp) * abs(amplitude));
}
