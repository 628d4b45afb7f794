#include "renderers/lit_ground.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "base/status.h"
#include "glm/common.hpp"

namespace thunderhead::renderers {
namespace {

// Radii of the three discs that approximate the sum of discs in lit_ground.h, relative to the
// height h. In that sum, the share of the discs with a radius below R is R^4 / (R^2 + h^2)^2. For
// the three radii this share is 1/6, 1/2 and 5/6.
constexpr std::array<float, 3> kDiscRadii = {0.830F, 1.554F, 3.238F};

// For each disc, the level of the map at which the disc is looked up from a height of one texel.
const std::array<float, 3> kDiscLevels = {std::log2(kDiscRadii[0]), std::log2(kDiscRadii[1]),
                                          std::log2(kDiscRadii[2])};

// A vertical wall receives half of its ground light from within this distance, in units of its
// height.
constexpr double kWallSees = 1.732;

}  // namespace

LitGround::LitGround(GroundMap map)
    : map_(std::move(map)),
      texels_per_m_(1.0 / map_.texel_m),
      mean_texels_per_m_(std::sqrt(texels_per_m_.x * texels_per_m_.y)) {
  const std::size_t count =
      static_cast<std::size_t>(map_.size.x) * static_cast<std::size_t>(map_.size.y);
  THUNDERHEAD_CHECK(map_.share.size() == count && map_.height_m.size() == count && count > 0,
                    std::to_string(count));
  Level finest(map_.size, 1.0F);
  auto share = map_.share.begin();
  for (int y = 0; y < map_.size.y; ++y) {
    for (int x = 0; x < map_.size.x; ++x) finest.At({x, y}) = 1.0F - *share++;
  }
  levels_.push_back(std::move(finest));
  while (levels_.back().size != glm::ivec2(1)) levels_.push_back(HalfOf(levels_.back()));
}

LitGround::Level::Level(const glm::ivec2& level_size, float level_scale)
    : size(level_size), scale(level_scale), row(level_size.x + 3) {
  dark.assign(static_cast<std::size_t>(row) * static_cast<std::size_t>(level_size.y + 3), 0.0F);
}

LitGround::Level LitGround::HalfOf(const Level& fine) {
  Level half((fine.size + 1) / 2, 0.5F * fine.scale);
  for (int y = 0; y < fine.size.y; ++y) {
    for (int x = 0; x < fine.size.x; ++x) half.At({x / 2, y / 2}) += 0.25F * fine.At({x, y});
  }
  return half;
}

// Interpolates the darkness between texel centres. `texel` is a place in units of the map's texels.
float LitGround::Dark(const Level& level, const glm::vec2& texel) {
  // Coordinates are relative to the centre of the border's first texel. With this order of min and
  // max, a NaN becomes 0.
  const glm::vec2 place =
      glm::min(glm::max(glm::vec2(0.0F), texel * level.scale + 0.5F), glm::vec2(level.size) + 1.0F);
  const glm::ivec2 first(place);
  const glm::vec2 at = place - glm::vec2(first);
  const float* const south = &level.dark[static_cast<std::size_t>(first.y * level.row + first.x)];
  const float* const north = south + level.row;
  return glm::mix(glm::mix(south[0], south[1], at.x), glm::mix(north[0], north[1], at.x), at.y);
}

float LitGround::DarkWithin(const glm::vec2& texel, float level) const {
  const auto last = static_cast<float>(levels_.size() - 1);
  if (level >= last) {
    // A disc wider than the map contains the darkness of the whole map. Its mean darkness is that
    // of the map times the ratio of the areas.
    const float shrunk = std::exp2(last - level);
    return Dark(levels_.back(), texel) * shrunk * shrunk;
  }
  const auto below = static_cast<std::size_t>(level);
  return glm::mix(Dark(levels_[below], texel), Dark(levels_[below + 1], texel),
                  level - static_cast<float>(below));
}

float LitGround::GroundHeight(const glm::vec2& texel) const {
  const glm::ivec2 cell(glm::min(glm::max(glm::vec2(0.0F), texel), glm::vec2(map_.size - 1)));
  return map_.height_m[static_cast<std::size_t>(cell.y * map_.size.x + cell.x)];
}

float LitGround::ShareAt(const glm::dvec3& place_m, const glm::vec3& outward) const {
  if (levels_.empty()) return 1.0F;
  const glm::dvec2 below((glm::dvec2(place_m) - map_.low_m) * texels_per_m_);
  const double height_m = std::max(place_m.z - GroundHeight(glm::vec2(below)), 0.0);
  const glm::vec2 texel(below + kWallSees * height_m * glm::dvec2(outward) * texels_per_m_);
  const auto height_texels = static_cast<float>(height_m * mean_texels_per_m_);
  const float level = std::log2(std::max(1e-6F, height_texels));
  float dark = 0.0F;
  for (const float of_disc : kDiscLevels) {
    dark += DarkWithin(texel, std::max(level + of_disc, 0.0F));
  }
  return 1.0F - dark / static_cast<float>(kDiscRadii.size());
}

}  // namespace thunderhead::renderers
