#include "volume/brick_map.h"

#include <algorithm>
#include <cmath>

#include "glm/common.hpp"
#include "glm/geometric.hpp"

namespace thunderhead::volume {
namespace {

constexpr double kBrickInCoarsestCells = 2.0;
constexpr int kMostCellsAcross = 16;
constexpr int kMostBricks = 1024;  // along an axis
constexpr int kFarthest = 254;

std::size_t Offset(const glm::ivec3& size, int x, int y, int z) {
  return (static_cast<std::size_t>(z) * static_cast<std::size_t>(size.y) +
          static_cast<std::size_t>(y)) *
             static_cast<std::size_t>(size.x) +
         static_cast<std::size_t>(x);
}

// Marks the bricks in which interpolation meets `cell`.
void Mark(const glm::ivec3& cell, std::uint8_t content, BrickMap* map) {
  const glm::ivec3 low = glm::max(cell - 1, glm::ivec3(0)) / map->cells_per_brick;
  const glm::ivec3 high = glm::min((cell + 1) / map->cells_per_brick, map->bricks - glm::ivec3(1));
  for (int z = low.z; z <= high.z; ++z) {
    for (int y = low.y; y <= high.y; ++y) {
      for (int x = low.x; x <= high.x; ++x) {
        std::uint8_t& brick = map->content[Offset(map->bricks, x, y, z)];
        if (brick != BrickMap::kThick) brick = content;
      }
    }
  }
}

// Half floats from zero up are ordered as their bits are.
std::uint16_t TexelOf(double extinction_per_m, const ExtinctionVolume& volume) {
  return HalfFromFloat(
      std::min(static_cast<float>(extinction_per_m) / volume.extinction_per_m, 65504.0F));
}

// `thin_per_m` is the extinction of a thin brick at most.
void MarkPlane(const ExtinctionPlane& plane, const ExtinctionVolume& volume, double thin_per_m,
               BrickMap* map) {
  const std::uint16_t empty = TexelOf(volume.negligible_per_m, volume);
  const std::uint16_t thin = TexelOf(thin_per_m, volume);
  const auto channels = static_cast<std::size_t>(plane.channels);
  const glm::ivec3 cells = volume.grid.cells;
  const std::uint16_t* texel = plane.texels.data();
  for (int z = 0; z < cells.z; ++z) {
    for (int y = 0; y < cells.y; ++y) {
      for (int x = 0; x < cells.x; ++x, texel += channels) {
        const std::uint16_t most = *std::max_element(texel, texel + channels);
        if (most > empty) {
          Mark({x, y, z}, most > thin ? BrickMap::kThick : BrickMap::kThin, map);
        }
      }
    }
  }
}

// One sweep over the bricks in order, or backwards: lowers each to the least distance of its
// `neighbours` plus one.
void LowerToNeighbours(const glm::ivec3& size, const std::vector<glm::ivec3>& neighbours,
                       bool forward, std::vector<std::uint8_t>* contents) {
  const int count = size.x * size.y * size.z;
  for (int i = 0; i < count; ++i) {
    const int at = forward ? i : count - 1 - i;
    const glm::ivec3 brick(at % size.x, at / size.x % size.y, at / (size.x * size.y));
    std::uint8_t& content = (*contents)[static_cast<std::size_t>(at)];
    if (content == BrickMap::kThick || content == BrickMap::kThin) continue;
    int lowest = content;
    for (const glm::ivec3& offset : neighbours) {
      const glm::ivec3 other = forward ? brick + offset : brick - offset;
      if (glm::any(glm::lessThan(other, glm::ivec3(0))) ||
          glm::any(glm::greaterThanEqual(other, size))) {
        continue;
      }
      const int there = (*contents)[Offset(size, other.x, other.y, other.z)];
      lowest = std::min(lowest, there == BrickMap::kThin ? 1 : there + 1);
    }
    content = static_cast<std::uint8_t>(lowest);
  }
}

}  // namespace

std::vector<std::uint32_t> BrickMap::Occupied() const {
  std::vector<std::uint32_t> occupied;
  for (std::size_t i = 0; i < content.size(); ++i) {
    if (content[i] != kThick && content[i] != kThin) continue;
    const auto nx = static_cast<std::size_t>(bricks.x);
    const auto ny = static_cast<std::size_t>(bricks.y);
    occupied.push_back(
        static_cast<std::uint32_t>(i % nx + 1024 * (i / nx % ny + 1024 * (i / (nx * ny)))));
  }
  return occupied;
}

BrickMap BrickMapOf(const ExtinctionVolume& volume) {
  BrickMap map;
  if (volume.Empty()) return map;
  const glm::dvec3 spacing_m = volume.grid.spacing_m;
  const double side_m = kBrickInCoarsestCells * std::max({spacing_m.x, spacing_m.y, spacing_m.z});
  map.cells_per_brick = glm::clamp(glm::ivec3(glm::round(side_m / spacing_m)), glm::ivec3(1),
                                   glm::ivec3(kMostCellsAcross));
  const glm::ivec3 fewest = (volume.grid.cells + kMostBricks - 1) / kMostBricks;
  map.cells_per_brick = glm::max(map.cells_per_brick, fewest);
  map.bricks = (volume.grid.cells + map.cells_per_brick - 1) / map.cells_per_brick;
  map.content.assign(Offset(map.bricks, 0, 0, map.bricks.z), kFarthest);
  const double way_m = glm::length(glm::dvec3(map.cells_per_brick) * spacing_m);
  int channels = 0;  // their extinctions add up
  for (const ExtinctionPlane& plane : volume.planes) channels += plane.channels;
  const double thin_per_m = BrickMap::kThinOpticalDepth / way_m / channels;
  for (const ExtinctionPlane& plane : volume.planes) MarkPlane(plane, volume, thin_per_m, &map);
  // Two sweeps over the 13 neighbours before a brick, and the 13 after it, give the exact
  // Chebyshev distance (Rosenfeld and Pfaltz 1966).
  std::vector<glm::ivec3> before;
  for (int z = -1; z <= 0; ++z) {
    for (int y = -1; y <= (z < 0 ? 1 : 0); ++y) {
      for (int x = -1; x <= (z < 0 || y < 0 ? 1 : -1); ++x) before.emplace_back(x, y, z);
    }
  }
  LowerToNeighbours(map.bricks, before, true, &map.content);
  LowerToNeighbours(map.bricks, before, false, &map.content);
  return map;
}

}  // namespace thunderhead::volume
