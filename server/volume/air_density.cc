#include "volume/air_density.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "glm/common.hpp"

namespace thunderhead::volume {
namespace {

// The number of columns that are sampled along each axis of a block.
constexpr int kSampledColumns = 4;

}  // namespace

float AirDensity::At(const RegularGrid& grid, int x, int y, int z) const {
  if (Empty()) return 0.0F;
  const glm::vec2 in_blocks =
      (glm::vec2(x, y) + 0.5F) * glm::vec2(blocks) / glm::vec2(glm::ivec2(grid.cells)) - 0.5F;
  const glm::vec2 place = glm::clamp(in_blocks, glm::vec2(0.0F), glm::vec2(blocks - 1));
  const glm::ivec2 low = glm::min(glm::ivec2(place), glm::max(blocks - 2, 0));
  const glm::ivec2 high = glm::min(low + 1, blocks - 1);
  const glm::vec2 share = place - glm::vec2(low);
  const auto value = [&](int i, int j) {
    return kg_per_m3[(static_cast<std::size_t>(z) * static_cast<std::size_t>(blocks.y) +
                      static_cast<std::size_t>(j)) *
                         static_cast<std::size_t>(blocks.x) +
                     static_cast<std::size_t>(i)];
  };
  return glm::mix(glm::mix(value(low.x, low.y), value(high.x, low.y), share.x),
                  glm::mix(value(low.x, high.y), value(high.x, high.y), share.x), share.y);
}

AirDensityMeans::AirDensityMeans(const RegularGrid& grid)
    : grid_(grid), blocks_(glm::min(glm::ivec2(grid.cells), glm::ivec2(kAirBlocks))) {
  sums_.assign(Offset({0, 0}, grid.cells.z), 0.0);
  weights_.assign(sums_.size(), 0.0);
}

glm::ivec2 AirDensityMeans::Stride() const {
  return glm::max(glm::ivec2(grid_.cells) / (kSampledColumns * blocks_), glm::ivec2(1));
}

void AirDensityMeans::Add(int x, int y, double bottom_m, double top_m, float density_kg_per_m3) {
  if (!(density_kg_per_m3 > 0.0F) || !(top_m > bottom_m)) return;
  const glm::ivec2 block = glm::ivec2(x, y) * blocks_ / glm::ivec2(grid_.cells);
  const double low = (bottom_m - grid_.low_corner_m.z) / grid_.spacing_m.z;
  const double high = (top_m - grid_.low_corner_m.z) / grid_.spacing_m.z;
  const int first = std::max(static_cast<int>(std::floor(low)), 0);
  const int last = std::min(static_cast<int>(std::ceil(high)), grid_.cells.z);
  for (int z = first; z < last; ++z) {
    const double weight = std::min(high, z + 1.0) - std::max(low, static_cast<double>(z));
    const std::size_t at = Offset(block, z);
    sums_[at] += weight * density_kg_per_m3;
    weights_[at] += weight;
  }
}

AirDensity AirDensityMeans::Means() const {
  AirDensity air{blocks_, std::vector<float>(sums_.size(), 0.0F)};
  for (int y = 0; y < blocks_.y; ++y) {
    for (int x = 0; x < blocks_.x; ++x) {
      // A level without air takes the density of the level with air below it. Levels under the
      // lowest level with air take the density of that level.
      int lowest = grid_.cells.z;
      float below = 0.0F;
      for (int z = 0; z < grid_.cells.z; ++z) {
        const std::size_t at = Offset({x, y}, z);
        if (weights_[at] > 0.0) {
          below = static_cast<float>(sums_[at] / weights_[at]);
          lowest = std::min(lowest, z);
        }
        air.kg_per_m3[at] = below;
      }
      if (lowest == grid_.cells.z) return {};  // the density of a block without air is unknown
      for (int z = 0; z < lowest; ++z) {
        air.kg_per_m3[Offset({x, y}, z)] = air.kg_per_m3[Offset({x, y}, lowest)];
      }
    }
  }
  return air;
}

std::size_t AirDensityMeans::Offset(const glm::ivec2& block, int z) const {
  return (static_cast<std::size_t>(z) * static_cast<std::size_t>(blocks_.y) +
          static_cast<std::size_t>(block.y)) *
             static_cast<std::size_t>(blocks_.x) +
         static_cast<std::size_t>(block.x);
}

}  // namespace thunderhead::volume
