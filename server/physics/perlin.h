// Octaves of Perlin's gradient noise (Perlin 1985; gradients along a cell's edges as in Perlin
// 2002) on a cube of texels that repeats without a seam. The computation uses integers, so it gives
// the same bits on every machine. This code does not use fields or GL.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace thunderhead::physics {

inline constexpr int kMaxPerlinSide = 128;  // texels along an edge of a tile
inline constexpr int kPerlinWaves = 8;      // wavelengths of the first octave along an edge
// Fixed-point value of a weight of 1.
inline constexpr std::int64_t kPerlinOne = std::int64_t{1} << 12U;
// Number of units of length in a lattice cell. Texel centres lie at odd multiples of half a texel.
// With at most 16 texels in a cell, half a texel is at least 1 / 32 of a cell.
inline constexpr std::int64_t kPerlinPlaceUnits = 2 * kMaxPerlinSide / kPerlinWaves;

struct PerlinGradient {
  std::int8_t x, y, z;
};

// The gradients of an octave at its lattice points, and the positions of its texels in a lattice
// cell. Positions are in units of 1 / kPerlinPlaceUnits of a cell.
struct PerlinOctave {
  int cells = 0;            // number of lattice cells along an edge of the tile
  int texels_per_cell = 0;  // at least 1
  std::vector<PerlinGradient> gradients;
  std::vector<std::int64_t> place;  // position of texel i in its cell
  std::vector<std::int64_t> fade;   // 6 t^5 - 15 t^4 + 10 t^3, in units of 1 / kPerlinOne

  const PerlinGradient& At(int x, int y, int z) const {
    const auto wrap = [this](int i) { return static_cast<std::size_t>(i % cells); };
    const auto side = static_cast<std::size_t>(cells);
    return gradients[(wrap(z) * side + wrap(y)) * side + wrap(x)];
  }
};

// Creates octave number `index`, counted from 0, of a tile with `side` texels along an edge. The
// octave has 2^index times kPerlinWaves cells along an edge, at most `side`.
PerlinOctave MakePerlinOctave(int index, int side, std::uint32_t seed);

// The contribution of the lattice points with the same x to the noise of a row of texels,
// interpolated in y and z. Along the row it is slope * place + offset, where the place is measured
// from that x.
struct PerlinCorner {
  std::int64_t slope = 0;
  std::int64_t offset = 0;
};

PerlinCorner CornerOf(const PerlinOctave& octave, int cell_x, int y, int z);

// Calls take(texel, noise) for each texel of the row (y, z). The magnitude of the noise is at most
// 2^42. The three weights are at most 2^12 each, and distances from a lattice point at most 2^5
// units. A gradient has two components that are not zero.
template <typename Take>
void AddPerlinRow(const PerlinOctave& octave, int y, int z, const Take& take) {
  PerlinCorner low = CornerOf(octave, 0, y, z);
  std::size_t texel = 0;
  for (int cell = 0; cell < octave.cells; ++cell) {
    const PerlinCorner high = CornerOf(octave, cell + 1, y, z);
    for (std::size_t i = 0; i < octave.place.size(); ++i, ++texel) {
      const std::int64_t at_low = low.slope * octave.place[i] + low.offset;
      const std::int64_t at_high = high.slope * (octave.place[i] - kPerlinPlaceUnits) + high.offset;
      take(texel, at_low * (kPerlinOne - octave.fade[i]) + at_high * octave.fade[i]);
    }
    low = high;
  }
}

}  // namespace thunderhead::physics
