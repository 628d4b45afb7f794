#include "volume/brick_map.h"

#include <algorithm>

#include "base/half_float.h"
#include "glm/common.hpp"
#include "glm/geometric.hpp"

namespace thunderhead::volume {
namespace {

constexpr double kBrickInCoarsestCells = 1.0;
constexpr double kBlockInCoarsestCells = 4.0;
constexpr int kMaxCellsAcross = 16;
constexpr int kMaxAlong = 1024;  // maximum number of bricks or blocks along an axis
constexpr int kFarthest = 254;

// Content of a cell or a brick, in increasing order.
constexpr std::uint8_t kEmpty = 0;
constexpr std::uint8_t kThin = 1;
constexpr std::uint8_t kThick = 2;

std::size_t Count(const glm::ivec3& size) {
  return static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
         static_cast<std::size_t>(size.z);
}

// Returns the number of cells along each side of a brick or block that is roughly a cube. The side
// is `side_in_coarsest` times the longest side of a cell. It is longer if an axis would otherwise
// hold more than kMaxAlong bricks, including the brick for the remaining cells.
glm::ivec3 CellsAcross(const RegularGrid& grid, double side_in_coarsest) {
  const glm::dvec3& spacing_m = grid.spacing_m;
  const double side_m = side_in_coarsest * std::max({spacing_m.x, spacing_m.y, spacing_m.z});
  return glm::max(glm::clamp(glm::ivec3(glm::round(side_m / spacing_m)), glm::ivec3(1),
                             glm::ivec3(kMaxCellsAcross)),
                  grid.cells / kMaxAlong + 1);
}

// Returns the half float of an extinction. Half floats of 0 or more compare like their bits.
std::uint16_t TexelOf(double extinction_per_m, const ExtinctionVolume& volume) {
  return base::HalfFromFloat(static_cast<float>(extinction_per_m) / volume.extinction_per_m);
}

// Raises each cell's content to the content (kEmpty, kThin or kThick) of the largest of its
// `channels` values.
template <int channels>
void RaiseFillings(const std::vector<std::uint16_t>& texels, std::uint16_t empty,
                   std::uint16_t thin, std::vector<std::uint8_t>* fillings) {
  const std::uint16_t* texel = texels.data();
  for (std::uint8_t& filling : *fillings) {
    std::uint16_t max = texel[0];
    for (int channel = 1; channel < channels; ++channel) max = std::max(max, texel[channel]);
    const auto here = static_cast<std::uint8_t>((max > empty ? 1 : 0) + (max > thin ? 1 : 0));
    filling = std::max(filling, here);
    texel += channels;
  }
}

// Returns the content of all cells. A channel's extinction is thin up to `thin_per_m`.
std::vector<std::uint8_t> FillingsOf(const ExtinctionVolume& volume, double thin_per_m) {
  const std::uint16_t empty = TexelOf(volume.negligible_per_m, volume);
  const std::uint16_t thin = std::max(TexelOf(thin_per_m, volume), empty);
  std::vector<std::uint8_t> fillings(Count(volume.grid.cells), kEmpty);
  for (const ExtinctionPlane& plane : volume.planes) {
    if (plane.channels == 1) RaiseFillings<1>(plane.texels, empty, thin, &fillings);
    if (plane.channels == 2) RaiseFillings<2>(plane.texels, empty, thin, &fillings);
    if (plane.channels == 4) RaiseFillings<4>(plane.texels, empty, thin, &fillings);
  }
  return fillings;
}

struct BrickRange {
  int first;
  int last;
};

// Applies a maximum filter and resamples along one axis. Output i of `count` is the maximum over
// the input range reach(i). `fillings` is an array of layers, each of `length` rows of `stride`
// values.
template <typename Reach>
std::vector<std::uint8_t> MaxAlong(const std::vector<std::uint8_t>& fillings, int stride,
                                   int length, int count, const Reach& reach) {
  const auto row = static_cast<std::size_t>(stride);
  const auto layer = row * static_cast<std::size_t>(length);
  std::vector<std::uint8_t> result(fillings.size() / layer * static_cast<std::size_t>(count) * row,
                                   kEmpty);
  std::uint8_t* out = result.data();
  for (const std::uint8_t* in = fillings.data(); in != fillings.data() + fillings.size();
       in += layer) {
    for (int i = 0; i < count; ++i, out += row) {
      const BrickRange range = reach(i);
      for (int j = std::max(range.first, 0); j <= std::min(range.last, length - 1); ++j) {
        const std::uint8_t* from = in + static_cast<std::size_t>(j) * row;
        for (std::size_t k = 0; k < row; ++k) out[k] = std::max(out[k], from[k]);
      }
    }
  }
  return result;
}

// Applies MaxAlong along all three axes, from `size` inputs to `count` outputs. Output i along
// `axis` is the maximum over the input range reach(axis, i).
template <typename Reach>
std::vector<std::uint8_t> MaxOf(const std::vector<std::uint8_t>& fillings, const glm::ivec3& size,
                                const glm::ivec3& count, const Reach& reach) {
  const auto along = [&](int axis) { return [&, axis](int i) { return reach(axis, i); }; };
  const auto by_z = MaxAlong(fillings, size.x * size.y, size.z, count.z, along(2));
  const auto by_y = MaxAlong(by_z, size.x, size.y, count.y, along(1));
  return MaxAlong(by_y, 1, size.x, count.x, along(0));
}

// Returns the content of all bricks.
std::vector<std::uint8_t> FillingsOf(const BrickMap& map) {
  std::vector<std::uint8_t> fillings(map.content.size());
  std::transform(
      map.content.begin(), map.content.end(), fillings.begin(), [](std::uint8_t content) {
        return content == BrickMap::kThick ? kThick : content == BrickMap::kThin ? kThin : kEmpty;
      });
  return fillings;
}

// Returns the bricks or blocks that are not empty, each encoded as x + 1024 (y + 1024 z), with
// `thick_bits` set if it is thick.
std::vector<std::uint32_t> Places(const std::vector<std::uint8_t>& fillings, const glm::ivec3& size,
                                  std::uint32_t thick_bits) {
  std::vector<std::uint32_t> places;
  const std::uint8_t* filling = fillings.data();
  for (int z = 0; z < size.z; ++z) {
    for (int y = 0; y < size.y; ++y) {
      const auto row = static_cast<std::uint32_t>(kMaxAlong * (y + kMaxAlong * z));
      for (int x = 0; x < size.x; ++x, ++filling) {
        if (*filling == kEmpty) continue;
        places.push_back((row + static_cast<std::uint32_t>(x)) |
                         (*filling == kThick ? thick_bits : 0U));
      }
    }
  }
  return places;
}

// Lowers each value of a row to at most one more than the minimum of its three neighbours in
// another row. Both rows have `count` values and a border value on both sides.
void LowerToRow(const std::uint8_t* beside, std::size_t count, std::uint8_t* row) {
  for (std::size_t x = 0; x < count; ++x) {
    const std::uint8_t min = std::min(std::min(beside[x], beside[x + 1]), beside[x + 2]);
    const auto one_more = static_cast<std::uint8_t>(min + 1);
    row[x + 1] = std::min(row[x + 1], one_more);
  }
}

// Chebyshev distances to the nearest brick that is not empty, at most kFarthest. Two sweeps compute
// them: over the 13 neighbours before each brick, then over the 13 after it. The result is exact
// (Rosenfeld and Pfaltz 1966).
class Distances {
 public:
  Distances(const std::vector<std::uint8_t>& fillings, const glm::ivec3& size)
      : size_(size),
        row_(static_cast<std::size_t>(size.x) + 2),
        values_(row_ * static_cast<std::size_t>(size.y) * static_cast<std::size_t>(size.z),
                kFarthest) {
    const std::uint8_t* filling = fillings.data();
    for (int z = 0; z < size.z; ++z) {
      for (int y = 0; y < size.y; ++y) {
        std::uint8_t* row = Row(y, z);
        for (int x = 0; x < size.x; ++x) row[x + 1] = *filling++ == kEmpty ? kFarthest : 0;
      }
    }
    for (int z = 0; z < size.z; ++z) {
      for (int y = 0; y < size.y; ++y) Sweep(y, z, 1);
    }
    for (int z = size.z - 1; z >= 0; --z) {
      for (int y = size.y - 1; y >= 0; --y) Sweep(y, z, -1);
    }
  }

  // Returns the distances of the bricks in a row.
  const std::uint8_t* Of(int y, int z) { return Row(y, z) + 1; }

 private:
  // Returns a row with a border value of kFarthest on both sides.
  std::uint8_t* Row(int y, int z) {
    return values_.data() +
           row_ * (static_cast<std::size_t>(y) +
                   static_cast<std::size_t>(size_.y) * static_cast<std::size_t>(z));
  }

  // Updates a row from the neighbours on one side. `before` is 1 for the neighbours before it, -1
  // for those after it.
  void Sweep(int y, int z, int before) {
    std::uint8_t* row = Row(y, z);
    const auto count = static_cast<std::size_t>(size_.x);
    const auto lower_to = [&](int other_y, int other_z) {
      if (other_y < 0 || other_y >= size_.y || other_z < 0 || other_z >= size_.z) return;
      LowerToRow(Row(other_y, other_z), count, row);
    };
    for (int dy = -1; dy <= 1; ++dy) lower_to(y + dy, z - before);
    lower_to(y - before, z);
    const int first = before > 0 ? 1 : size_.x;
    const int end = before > 0 ? size_.x + 1 : 0;
    for (int x = first; x != end; x += before) {
      row[x] = static_cast<std::uint8_t>(std::min<int>(row[x], row[x - before] + 1));
    }
  }

  glm::ivec3 size_;
  std::size_t row_;
  std::vector<std::uint8_t> values_;
};

}  // namespace

BrickMap BrickMapOf(const ExtinctionVolume& volume) {
  BrickMap map;
  if (volume.Empty()) return map;
  const glm::ivec3 cells = volume.grid.cells;
  const glm::ivec3 across = CellsAcross(volume.grid, kBrickInCoarsestCells);
  map.cells_per_brick = across;
  map.bricks = cells / across + 1;
  const double diagonal_m = glm::length(glm::dvec3(across) * volume.grid.spacing_m);
  // The extinctions of all channels add up, so each channel gets a share of the threshold.
  const std::vector<std::uint8_t> fillings =
      MaxOf(FillingsOf(volume, BrickMap::kThinOpticalDepth / diagonal_m / volume.Channels()), cells,
            map.bricks, [&](int axis, int brick) {
              const int n = across[axis];
              return BrickRange{brick * n - 1, (brick + 1) * n - 1};
            });
  Distances distances(fillings, map.bricks);
  map.content.reserve(fillings.size());
  for (int z = 0; z < map.bricks.z; ++z) {
    for (int y = 0; y < map.bricks.y; ++y) {
      const std::uint8_t* distance = distances.Of(y, z);
      map.content.insert(map.content.end(), distance, distance + map.bricks.x);
    }
  }
  for (std::size_t i = 0; i < fillings.size(); ++i) {
    if (fillings[i] == kThin) map.content[i] = BrickMap::kThin;
  }
  return map;
}

BrickCubes OccupiedCubesOf(const BrickMap& map, std::size_t max_cubes) {
  BrickCubes cubes;
  glm::ivec3 size = map.bricks;
  std::vector<std::uint8_t> fillings = FillingsOf(map);
  const auto occupied = [&] {
    return fillings.size() -
           static_cast<std::size_t>(std::count(fillings.begin(), fillings.end(), kEmpty));
  };
  while (occupied() > max_cubes) {
    const glm::ivec3 halved = (size + 1) / 2;
    fillings = MaxOf(fillings, size, halved, [](int, int cube) {
      return BrickRange{2 * cube, 2 * cube + 1};
    });
    size = halved;
    cubes.bricks_across *= 2;
  }
  cubes.occupied = Places(fillings, size, 0U);
  return cubes;
}

CellBlocks CellBlocksOf(const BrickMap& map, const RegularGrid& grid) {
  CellBlocks blocks;
  if (map.content.empty()) return blocks;
  blocks.cells_per_block = CellsAcross(grid, kBlockInCoarsestCells);
  const glm::ivec3 size = (grid.cells - 1) / blocks.cells_per_block + 1;
  // Interpolation in the brick that begins after a cell also reads the cell, so the range includes
  // that brick.
  const std::vector<std::uint8_t> fillings =
      MaxOf(FillingsOf(map), map.bricks, size, [&](int axis, int block) {
        const int side = blocks.cells_per_block[axis];
        const int n = map.cells_per_brick[axis];
        return BrickRange{block * side / n, (block + 1) * side / n};
      });
  blocks.occupied = Places(fillings, size, CellBlocks::kThick);
  return blocks;
}

}  // namespace thunderhead::volume
