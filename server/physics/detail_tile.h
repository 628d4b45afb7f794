// Noise of detail finer than a model's grid, on a tile that repeats without a seam: billows, the
// sum over octaves of |Perlin noise| (Perlin 1985), by rank, so that all values are equally
// frequent; and a displacement, three smooth noises. The bits are the same on every machine. How it
// changes a medium is GLSL that also compiles as C++ (shaders/physics/detail.glsl). Knows no fields
// and no GL.
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
  static constexpr int kWaves = kPerlinWaves;   // of the longest wavelength along an edge

  // kSide^3 times four bytes, x fastest: billows, 0 to 255; the displacement along x, y and z,
  // where 127.5 is none.
  std::vector<std::uint8_t> texels;
};

// The longest wavelength is kSide / kWaves texels; billows have `octaves` (1 to kMaxDetailOctaves)
// of half the wavelength each, the displacement has two.
DetailTile MakeDetailTile(int octaves, std::uint32_t seed);

// Means of 2 x 2 x 2 of the texels of a tile with `side` of them along an edge, an even number.
std::vector<std::uint8_t> CoarserLevel(const std::vector<std::uint8_t>& texels, int side);

// From places in tiles of billows to places in tiles of fibres: turned so that x is the shear's
// direction, stretched along it and narrower across it. Without a shear they lie from west to east,
// as winds aloft usually blow.
glm::dmat3 FibresAlong(const glm::dvec2& shear_m_per_s);

// How far noise that drifts with `wind_m_per_s` has come at a time, in seconds from any midnight,
// less whole tiles. The wind is rounded to whole tiles in three hours (kDriftPeriod_s), so that
// billows never jump while the rounded wind lasts. Fibres, whose tile is another, do.
glm::dvec2 DetailDrift_m(const glm::dvec2& wind_m_per_s, double time_s, double tile_m);

// The largest displacement of a medium with such cells: less than what would change the order of
// neighbouring cells.
glm::dvec3 DetailWarp_m(const glm::dvec3& cell_m, double wavelength_m);

// A texel at `place`, in units of a tile's edge, sampled as a repeating texture: billows 0 to 1,
// and the displacement, -1 to 1.
glm::dvec4 DetailNoiseAt(const DetailTile& tile, const glm::dvec3& place);

}  // namespace thunderhead::physics
