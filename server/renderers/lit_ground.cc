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

// Of the discs, R^4 / (R^2 + h^2)^2 are smaller than R: here 1/6, 1/2 and 5/6.
constexpr std::array<float, 3> kDiscRadii = {0.830F, 1.554F, 3.238F};

// A wall gets half of its light from the ground from within this distance, in heights.
constexpr double kWallSees = 1.732;

}  // namespace

LitGround::LitGround(GroundMap map) : map_(std::move(map)) {
  const std::size_t count =
      static_cast<std::size_t>(map_.size.x) * static_cast<std::size_t>(map_.size.y);
  THUNDERHEAD_CHECK(map_.share.size() == count && map_.height_m.size() == count && count > 0,
                    std::to_string(count));
  Level finest{map_.size, {}};
  finest.dark.reserve(count);
  for (const float share : map_.share) finest.dark.push_back(1.0F - share);
  levels_.push_back(std::move(finest));
  while (levels_.back().size != glm::ivec2(1)) levels_.push_back(HalfOf(levels_.back()));
}

LitGround::Level LitGround::HalfOf(const Level& fine) {
  Level half{(fine.size + 1) / 2, {}};
  half.dark.assign(static_cast<std::size_t>(half.size.x) * static_cast<std::size_t>(half.size.y),
                   0.0F);
  for (int y = 0; y < fine.size.y; ++y) {
    for (int x = 0; x < fine.size.x; ++x) {
      const auto from = static_cast<std::size_t>(y * fine.size.x + x);
      const auto to = static_cast<std::size_t>(y / 2 * half.size.x + x / 2);
      half.dark[to] += 0.25F * fine.dark[from];
    }
  }
  return half;
}

// Interpolated between texels' centres, at a place in the level's texels.
float LitGround::Dark(const Level& level, const glm::vec2& texel) const {
  const glm::vec2 from_centre = texel - 0.5F;
  const glm::vec2 low = glm::floor(from_centre);
  const glm::vec2 at = from_centre - low;
  const auto here = [&](int x, int y) {
    if (x < 0 || y < 0 || x >= level.size.x || y >= level.size.y) return 0.0F;
    return level.dark[static_cast<std::size_t>(y * level.size.x + x)];
  };
  const glm::ivec2 first(low);
  const float south = glm::mix(here(first.x, first.y), here(first.x + 1, first.y), at.x);
  const float north = glm::mix(here(first.x, first.y + 1), here(first.x + 1, first.y + 1), at.x);
  return glm::mix(south, north, at.y);
}

float LitGround::DarkWithin(const glm::vec2& texel, float radius_texels) const {
  const float level = std::log2(std::max(radius_texels, 1.0F));
  const auto last = static_cast<float>(levels_.size() - 1);
  const auto at = [&](float number) {
    const float scale = std::exp2(-number);
    return Dark(levels_[static_cast<std::size_t>(number)], texel * scale);
  };
  if (level >= last) {
    // A disc wider than the map has in it the dark of the whole map, in proportion.
    const float shrunk = std::exp2(last - level);
    return at(last) * shrunk * shrunk;
  }
  const float below = std::floor(level);
  return glm::mix(at(below), at(below + 1.0F), level - below);
}

float LitGround::GroundHeight(const glm::vec2& texel) const {
  const glm::ivec2 cell = glm::clamp(glm::ivec2(glm::floor(texel)), glm::ivec2(0), map_.size - 1);
  return map_.height_m[static_cast<std::size_t>(cell.y * map_.size.x + cell.x)];
}

float LitGround::ShareAt(const glm::dvec3& place_m, const glm::vec3& outward) const {
  if (levels_.empty()) return 1.0F;
  const glm::dvec2 below((glm::dvec2(place_m) - map_.low_m) / map_.texel_m);
  const double height_m = std::max(place_m.z - GroundHeight(glm::vec2(below)), 0.0);
  const glm::vec2 texel(below + kWallSees * height_m * glm::dvec2(outward) / map_.texel_m);
  const auto height_texels =
      static_cast<float>(height_m / std::sqrt(map_.texel_m.x * map_.texel_m.y));
  float dark = 0.0F;
  for (const float radius : kDiscRadii) dark += DarkWithin(texel, radius * height_texels);
  return 1.0F - dark / static_cast<float>(kDiscRadii.size());
}

}  // namespace thunderhead::renderers
