#include "physics/turbulence.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "base/status.h"
#include "glm/common.hpp"
#include "physics/perlin.h"

namespace thunderhead::physics {
namespace {

// Limits of the tile's side. With five octaves, the finest octave has only one texel in each
// lattice cell, because a larger tile would cost more than it gains.
constexpr int kSmallestSide = 64;
constexpr int kLargestSide = 128;
static_assert(kLargestSide <= kMaxPerlinSide);

constexpr std::size_t kOneInClear = 3;

// Subtracts a threshold from the noise and sets smaller values to zero. This creates sheets of
// clear air between the billows. The threshold leaves the share 1 / kOneInClear of the tile empty.
void FillTexels(const std::vector<std::uint32_t>& sums, TurbulenceTile* tile) {
  std::vector<std::uint32_t> sorted = sums;
  const auto clear = sorted.begin() + static_cast<std::ptrdiff_t>(sums.size() / kOneInClear);
  std::nth_element(sorted.begin(), clear, sorted.end());
  const std::uint64_t threshold = *clear;
  const std::uint64_t range = *std::max_element(clear, sorted.end()) - threshold;
  tile->texels.reserve(sums.size());
  for (const std::uint64_t sum : sums) {
    const std::uint64_t above = sum > threshold ? sum - threshold : 0;
    tile->texels.push_back(static_cast<std::uint8_t>((above * 255 + range / 2) / range));
  }
}

// Returns for each texel the sum of the texel, weighted by 4, and its two neighbours along an axis,
// weighted by 1.
std::vector<std::uint32_t> Spread(const std::vector<std::uint32_t>& values, std::size_t side,
                                  std::size_t stride) {
  std::vector<std::uint32_t> spread(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t at = i / stride % side;
    const std::size_t line = i - at * stride;
    const std::size_t before = line + (at + side - 1) % side * stride;
    const std::size_t after = line + (at + 1) % side * stride;
    spread[i] = values[before] + 4 * values[i] + values[after];
  }
  return spread;
}

// Returns the exact mean square of the linear interpolant between texels. Texels are scaled to the
// range from 0 to 1.
double MeanSquare(const TurbulenceTile& tile) {
  const auto side = static_cast<std::size_t>(tile.side);
  std::vector<std::uint32_t> spread(tile.texels.begin(), tile.texels.end());
  for (const std::size_t stride : {std::size_t{1}, side, side * side}) {
    spread = Spread(spread, side, stride);
  }
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < spread.size(); ++i) sum += std::uint64_t{tile.texels[i]} * spread[i];
  return static_cast<double>(sum) /
         (6.0 * 6.0 * 6.0 * 255.0 * 255.0 * static_cast<double>(spread.size()));
}

}  // namespace

TurbulenceTile MakeTurbulence(int octaves, std::uint32_t seed) {
  THUNDERHEAD_CHECK(octaves >= 1 && octaves <= kMaxTurbulenceOctaves, std::to_string(octaves));
  TurbulenceTile tile;
  // The finest octave should have two texels in each lattice cell.
  tile.side = std::clamp(TurbulenceTile::kWaves << octaves, kSmallestSide, kLargestSide);
  const auto side = static_cast<std::size_t>(tile.side);
  std::vector<PerlinOctave> parts;
  parts.reserve(static_cast<std::size_t>(octaves));
  for (int i = 0; i < octaves; ++i) parts.push_back(MakePerlinOctave(i, tile.side, seed));
  std::vector<std::uint32_t> sums;
  sums.reserve(side * side * side);
  std::vector<std::uint64_t> row(side);
  for (int z = 0; z < tile.side; ++z) {
    for (int y = 0; y < tile.side; ++y) {
      std::fill(row.begin(), row.end(), 0);
      for (int i = 0; i < octaves; ++i) {
        AddPerlinRow(parts[static_cast<std::size_t>(i)], y, z,
                     [&](std::size_t texel, std::int64_t noise) {
                       row[texel] += static_cast<std::uint64_t>(noise < 0 ? -noise : noise) >>
                                     static_cast<unsigned>(i);
                     });
      }
      // The noise of the first octave is at most 2^42 (AddPerlinRow), and each further octave
      // counts half, so the sums are below 2^43. The shift makes them fit into 32 bits.
      for (const std::uint64_t sum : row) sums.push_back(static_cast<std::uint32_t>(sum >> 12U));
    }
  }
  FillTexels(sums, &tile);
  tile.value_of_full = static_cast<float>(1.0 / MeanSquare(tile));
  return tile;
}

double TurbulenceAt(const TurbulenceTile& tile, const glm::dvec3& place) {
  const glm::dvec3 texel = (place - glm::floor(place)) * static_cast<double>(tile.side) - 0.5;
  const glm::dvec3 floor = glm::floor(texel);
  const glm::dvec3 share = texel - floor;
  const auto wrap = [&](double i) {
    return static_cast<std::size_t>(static_cast<int>(i) & (tile.side - 1));
  };
  const auto side = static_cast<std::size_t>(tile.side);
  double sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 step(corner & 1, (corner >> 1) & 1, corner >> 2);
    const glm::dvec3 weight = glm::mix(1.0 - share, share, step);
    const std::size_t offset =
        (wrap(floor.z + step.z) * side + wrap(floor.y + step.y)) * side + wrap(floor.x + step.x);
    sum += weight.x * weight.y * weight.z * tile.texels[offset];
  }
  const double fetched = sum / 255.0;
  return fetched * fetched * tile.value_of_full;
}

}  // namespace thunderhead::physics
