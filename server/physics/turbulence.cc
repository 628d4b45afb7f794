#include "physics/turbulence.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>

#include "base/status.h"
#include "glm/common.hpp"
#include "physics/counter_random.h"

namespace thunderhead::physics {
namespace {

// Finer octaves would need more texels than they are worth: the finest of five has one a cell.
constexpr int kSmallestSide = 64;
constexpr int kLargestSide = 128;

constexpr std::size_t kOneInClear = 3;

constexpr int kFadeBits = 12;
constexpr std::int64_t kFadeOne = std::int64_t{1} << kFadeBits;
// Texels' middles lie at odd multiples of half a texel: with at most 16 texels a cell, of 1 / 32.
constexpr std::int64_t kPlaceUnits = 2 * kLargestSide / TurbulenceTile::kWaves;

struct Gradient {
  std::int8_t x, y, z;
};

constexpr std::array<Gradient, 12> kEdges = {{{1, 1, 0},
                                              {-1, 1, 0},
                                              {1, -1, 0},
                                              {-1, -1, 0},
                                              {1, 0, 1},
                                              {-1, 0, 1},
                                              {1, 0, -1},
                                              {-1, 0, -1},
                                              {0, 1, 1},
                                              {0, -1, 1},
                                              {0, 1, -1},
                                              {0, -1, -1}}};

// Positions of an octave's texels in its lattice cells, in units of 1 / kPlaceUnits of a cell.
struct Octave {
  int cells = 0;            // along an edge of the tile
  int texels_per_cell = 0;  // at least 1
  std::vector<Gradient> gradients;
  std::vector<std::int64_t> place;  // of texel i in its cell
  std::vector<std::int64_t> fade;   // 6 t^5 - 15 t^4 + 10 t^3, in units of 1 / kFadeOne

  const Gradient& At(int x, int y, int z) const {
    const auto wrap = [this](int i) { return static_cast<std::size_t>(i % cells); };
    const auto side = static_cast<std::size_t>(cells);
    return gradients[(wrap(z) * side + wrap(y)) * side + wrap(x)];
  }
};

Octave MakeOctave(int index, int side, std::uint32_t seed) {
  Octave octave;
  octave.cells = TurbulenceTile::kWaves << index;
  octave.texels_per_cell = side / octave.cells;
  const auto count = static_cast<std::size_t>(octave.cells) *
                     static_cast<std::size_t>(octave.cells) *
                     static_cast<std::size_t>(octave.cells);
  for (std::size_t i = 0; i < count; ++i) {
    CounterRandom random(seed, (static_cast<std::uint64_t>(index) << 32U) | i);
    octave.gradients.push_back(kEdges[static_cast<std::size_t>(random.Next() * kEdges.size())]);
  }
  constexpr std::int64_t kFifth =
      kPlaceUnits * kPlaceUnits * kPlaceUnits * kPlaceUnits * kPlaceUnits;
  for (int i = 0; i < octave.texels_per_cell; ++i) {
    const std::int64_t p = (2 * i + 1) * kPlaceUnits / (2 * octave.texels_per_cell);
    octave.place.push_back(p);
    const std::int64_t fade =
        p * p * p * (6 * p * p - 15 * p * kPlaceUnits + 10 * kPlaceUnits * kPlaceUnits);
    octave.fade.push_back((fade * kFadeOne + kFifth / 2) / kFifth);
  }
  return octave;
}

// The gradients at one lattice point of a row, already interpolated across the row: noise along it
// is slope * place + offset.
struct RowCorner {
  std::int64_t slope = 0;
  std::int64_t offset = 0;
};

RowCorner CornerOf(const Octave& octave, int cell_x, int y, int z) {
  const int in_y = y % octave.texels_per_cell;
  const int in_z = z % octave.texels_per_cell;
  RowCorner corner;
  for (int step = 0; step < 4; ++step) {
    const int step_y = step & 1;
    const int step_z = step >> 1;
    const Gradient& gradient =
        octave.At(cell_x, y / octave.texels_per_cell + step_y, z / octave.texels_per_cell + step_z);
    const std::int64_t fade_y = octave.fade[static_cast<std::size_t>(in_y)];
    const std::int64_t fade_z = octave.fade[static_cast<std::size_t>(in_z)];
    const std::int64_t weight =
        (step_y == 1 ? fade_y : kFadeOne - fade_y) * (step_z == 1 ? fade_z : kFadeOne - fade_z);
    const std::int64_t from_y = octave.place[static_cast<std::size_t>(in_y)] - step_y * kPlaceUnits;
    const std::int64_t from_z = octave.place[static_cast<std::size_t>(in_z)] - step_z * kPlaceUnits;
    corner.slope += weight * gradient.x;
    corner.offset += weight * (gradient.y * from_y + gradient.z * from_z);
  }
  return corner;
}

// Adds |noise| of one octave along the row (y, z), halved `index` times.
void AddRow(const Octave& octave, int index, int y, int z, std::vector<std::uint64_t>* row) {
  RowCorner low = CornerOf(octave, 0, y, z);
  std::size_t texel = 0;
  for (int cell = 0; cell < octave.cells; ++cell) {
    const RowCorner high = CornerOf(octave, cell + 1, y, z);
    for (std::size_t i = 0; i < octave.place.size(); ++i, ++texel) {
      const std::int64_t at_low = low.slope * octave.place[i] + low.offset;
      const std::int64_t at_high = high.slope * (octave.place[i] - kPlaceUnits) + high.offset;
      const std::int64_t noise = at_low * (kFadeOne - octave.fade[i]) + at_high * octave.fade[i];
      (*row)[texel] +=
          static_cast<std::uint64_t>(noise < 0 ? -noise : noise) >> static_cast<unsigned>(index);
    }
    low = high;
  }
}

// Noise below the threshold becomes zero: sheets of clear air between the billows. The threshold is
// such that kClearShare of the tile is empty.
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

// Adds up each texel with its neighbours along an axis, weighted by 1, 4 and 1.
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

// Exact mean square of the linear interpolant between texels; texels count from 0 to 1.
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
  // Two texels a cell of the finest octave.
  tile.side = std::clamp(TurbulenceTile::kWaves << octaves, kSmallestSide, kLargestSide);
  const auto side = static_cast<std::size_t>(tile.side);
  std::vector<Octave> parts;
  parts.reserve(static_cast<std::size_t>(octaves));
  for (int i = 0; i < octaves; ++i) parts.push_back(MakeOctave(i, tile.side, seed));
  std::vector<std::uint32_t> sums;
  sums.reserve(side * side * side);
  std::vector<std::uint64_t> row(side);
  for (int z = 0; z < tile.side; ++z) {
    for (int y = 0; y < tile.side; ++y) {
      std::fill(row.begin(), row.end(), 0);
      for (int i = 0; i < octaves; ++i) {
        AddRow(parts[static_cast<std::size_t>(i)], i, y, z, &row);
      }
      // Below 2^43 before: three fades of 12 bits, a place of 5, and a factor of 4.
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
