// Noise for detail finer than a model's grid, on a tile that repeats without a seam. The tile holds
// billows and a displacement. Billows are the sum over octaves of |Perlin noise| (Perlin 1985).
// Each value is replaced by its rank, so that all values are equally frequent. The displacement
// consists of three smooth noises. The bits are the same on every machine. The code that applies
// the noise to a medium is GLSL that also compiles as C++ (shaders/physics/detail.glsl). This code
// does not use fields or GL.
#pragma once

#include <cstdint>
#include <vector>

#include "glm/common.hpp"
#include "glm/mat3x3.hpp"
#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "glm/vec4.hpp"
#include "physics/perlin.h"

namespace thunderhead::physics {
namespace glsl {

using glm::abs;
using glm::clamp;
using glm::min;
using glm::vec2;
#include "shaders/physics/detail.glsl"

}  // namespace glsl

inline constexpr int kMaxDetailOctaves = 5;

struct DetailTile {
  static constexpr int kSide = kMaxPerlinSide;  // texels along an edge
  static constexpr int kWaves = kPerlinWaves;   // number of the longest wavelengths along an edge

  // kSide^3 texels of four bytes, with x varying fastest. The first byte is the billows, 0 to 255.
  // The others are the displacement along x, y and z, which is zero at 127.5.
  std::vector<std::uint8_t> texels;
};

// Creates a tile. The longest wavelength is kSide / kWaves texels. Billows have `octaves` octaves
// (1 to kMaxDetailOctaves), each with half the wavelength of the octave before. The displacement
// has two octaves.
DetailTile MakeDetailTile(int octaves, std::uint32_t seed);

// Returns the next coarser level of a tile: the means of 2 x 2 x 2 texels. `side` is the number of
// texels along an edge, an even number.
std::vector<std::uint8_t> CoarserLevel(const std::vector<std::uint8_t>& texels, int side);

// Returns the transformation from places in tiles of billows to places in tiles of fibres, which
// are streaks of ice and snow. It rotates x to the direction of the wind shear, stretches fibres
// along it and narrows them across it. If the shear is 1 m/s or less, fibres lie from west to east,
// as winds aloft usually blow.
glm::dmat3 FibresAlong(const glm::dvec2& shear_m_per_s);

// Returns how far noise that drifts with `wind_m_per_s` has moved at a time, modulo the tile size.
// `time_s` is in seconds from any midnight. The wind is rounded so that the noise moves by whole
// tiles in three hours (kDriftPeriod_s). Billows repeat with the tile, so they never jump while the
// rounded wind stays the same. Fibres have tiles of another size, so they jump when the result
// wraps around.
glm::dvec2 DetailDrift_m(const glm::dvec2& wind_m_per_s, double time_s, double tile_m);

// Returns the largest displacement of a medium with cells of the size `cell_m`. It is at most a
// cell, two cells upwards, and a quarter of the wavelength, so neighbouring cells mostly keep their
// order.
glm::dvec3 DetailWarp_m(const glm::dvec3& cell_m, double wavelength_m);

// Samples the tile as a repeating texture at `place`, in units of a tile's edge. Returns billows, 0
// to 1, and the displacement, -1 to 1.
glm::dvec4 DetailNoiseAt(const DetailTile& tile, const glm::dvec3& place);

}  // namespace thunderhead::physics
