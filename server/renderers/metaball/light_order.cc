#include "renderers/metaball/light_order.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "glm/common.hpp"

namespace thunderhead::renderers {
namespace {

// Side, in texels, of the blocks used to find overlaps. Two discs that touch the same block count
// as overlapping.
constexpr int kBlock = 8;

// The range of blocks that a disc may touch. `high` is included.
struct Blocks {
  glm::ivec2 low{0};
  glm::ivec2 high{0};
};

Blocks BlocksOf(const LightDisc& disc, const glm::ivec2& size) {
  const glm::dvec2 last(size - 1);
  const glm::dvec2 low = glm::clamp(glm::floor(disc.middle - disc.reach - 1.0), {0.0, 0.0}, last);
  const glm::dvec2 high = glm::clamp(glm::ceil(disc.middle + disc.reach + 1.0), {0.0, 0.0}, last);
  return {glm::ivec2(low) / kBlock, glm::ivec2(high) / kBlock};
}

}  // namespace

LightOrder OrderFromLight(const std::vector<LightDisc>& discs, const glm::ivec2& size) {
  std::vector<std::uint32_t> sorted(discs.size());
  std::iota(sorted.begin(), sorted.end(), 0U);
  std::stable_sort(sorted.begin(), sorted.end(), [&](std::uint32_t a, std::uint32_t b) {
    return discs[a].towards_light > discs[b].towards_light;
  });
  const glm::ivec2 blocks = (size + kBlock - 1) / kBlock;
  // For each block, the first level in which no disc touches it yet.
  std::vector<std::uint32_t> free(static_cast<std::size_t>(blocks.x) *
                                  static_cast<std::size_t>(blocks.y));
  const auto at = [&](int x, int y) -> std::uint32_t& {
    return free[static_cast<std::size_t>(y) * static_cast<std::size_t>(blocks.x) +
                static_cast<std::size_t>(x)];
  };
  std::vector<std::uint32_t> level_of(discs.size());
  std::uint32_t levels = 0;
  for (const std::uint32_t disc : sorted) {
    const Blocks own = BlocksOf(discs[disc], size);
    std::uint32_t level = 0;
    for (int y = own.low.y; y <= own.high.y; ++y) {
      for (int x = own.low.x; x <= own.high.x; ++x) level = std::max(level, at(x, y));
    }
    for (int y = own.low.y; y <= own.high.y; ++y) {
      for (int x = own.low.x; x <= own.high.x; ++x) at(x, y) = level + 1;
    }
    level_of[disc] = level;
    levels = std::max(levels, level + 1);
  }
  LightOrder order;
  order.discs = std::move(sorted);
  std::stable_sort(order.discs.begin(), order.discs.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return level_of[a] < level_of[b]; });
  order.starts.push_back(0);
  for (std::uint32_t level = 0; level < levels; ++level) {
    std::uint32_t end = order.starts.back();
    while (end < order.discs.size() && level_of[order.discs[end]] == level) ++end;
    order.starts.push_back(end);
  }
  return order;
}

}  // namespace thunderhead::renderers
