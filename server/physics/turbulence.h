// Turbulent structure finer than a model's grid: billows with clear air between them, on a tile
// that repeats without a seam. The noise is Perlin's turbulence (Perlin 1985; gradients along a
// cell's edges as in Perlin 2002), the sum over octaves of |noise|. Its excess over a threshold is
// squared. A third of the tile is below the threshold and therefore empty. These gaps let a viewer
// see into a storm whose cells can have an optical depth of 100. Values are never negative and have
// mean 1, so a field multiplied by them keeps its mass on average. The computation uses integers,
// so it gives the same bits on every machine. This code does not use fields or GL.
#pragma once

#include <cstdint>
#include <vector>

#include "glm/vec3.hpp"

namespace thunderhead::physics {

inline constexpr int kMaxTurbulenceOctaves = 5;

// A cube of noise samples at the texel centres. Texels store the square root of the noise, which is
// interpolated linearly between texels.
struct TurbulenceTile {
  // Number of wavelengths of the first octave along an edge of the tile.
  static constexpr int kWaves = 8;

  int side = 0;                      // texels along an edge, a power of two
  std::vector<std::uint8_t> texels;  // side^3, x fastest
  // The largest value of the noise, which the texel value 255 stands for.
  float value_of_full = 0.0F;
};

// Creates a tile. `octaves` is 1 to kMaxTurbulenceOctaves. Each octave has half the wavelength and
// half the amplitude of the octave before.
TurbulenceTile MakeTurbulence(int octaves, std::uint32_t seed);

// Samples the noise as a repeating texture at `place`, which is in units of a tile's edge.
double TurbulenceAt(const TurbulenceTile& tile, const glm::dvec3& place);

}  // namespace thunderhead::physics
