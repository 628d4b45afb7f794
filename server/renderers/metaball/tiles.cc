#include "renderers/metaball/tiles.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "glm/common.hpp"
#include "glm/geometric.hpp"

namespace thunderhead::renderers {
namespace {

constexpr int kMinBallTile_px = 16;

// Maximum number of entries in all lists together: 16 MB on the device.
constexpr std::size_t kMaxListed = std::size_t{1} << 22U;

// The rectangle around a ball in normalised device coordinates. It is empty if `low` is above
// `high`.
struct BallCover {
  glm::dvec2 low{-1.0};
  glm::dvec2 high{1.0};
};

constexpr BallCover kNothing = {glm::dvec2(1.0), glm::dvec2(-1.0)};

// Returns the interval of tangents of the angles at which a ball is seen along one axis. `x` is
// across the view direction and `z` along it. The whole ball must be in front of the eye.
glm::dvec2 Tangents(double x, double z, double radius) {
  const double root = radius * std::sqrt(std::max(x * x + z * z - radius * radius, 0.0));
  return glm::dvec2(x * z - root, x * z + root) / (z * z - radius * radius);
}

BallCover CoverOf(const Ball& ball, const scene::View& view) {
  const glm::dvec3 off_m = ball.middle_m - view.eye_m;
  const double x = glm::dot(off_m, view.right);
  const double y = glm::dot(off_m, view.up);
  const double z = glm::dot(off_m, view.forward);
  if (z <= -ball.radius_m) return kNothing;
  if (view.Orthographic()) {
    const glm::dvec2 half_m(view.half_width_m, view.half_height_m);
    return {(glm::dvec2(x, y) - ball.radius_m) / half_m,
            (glm::dvec2(x, y) + ball.radius_m) / half_m};
  }
  if (z <= 1.001 * ball.radius_m) return {};
  const glm::dvec2 across = Tangents(x, z, ball.radius_m) / view.tan_half_width;
  const glm::dvec2 upwards = Tangents(y, z, ball.radius_m) / view.tan_half_height;
  return {{across.x, upwards.x}, {across.y, upwards.y}};
}

// The range of tiles that a ball's rectangle touches. `high` is included.
struct TileRange {
  glm::ivec2 low{0};
  glm::ivec2 high{-1};

  std::size_t Count() const {
    const glm::ivec2 count = glm::max(high - low + 1, glm::ivec2(0));
    return static_cast<std::size_t>(count.x) * static_cast<std::size_t>(count.y);
  }
};

TileRange RangeOf(const BallCover& cover, const glm::ivec2& size_px, int tile_px) {
  if (cover.low.x >= cover.high.x || cover.low.y >= cover.high.y || cover.low.x >= 1.0 ||
      cover.low.y >= 1.0 || cover.high.x <= -1.0 || cover.high.y <= -1.0) {
    return {};
  }
  // One more pixel on each side compensates for rounding errors.
  const glm::dvec2 low_px =
      (glm::clamp(cover.low, {-1.0, -1.0}, {1.0, 1.0}) * 0.5 + 0.5) * glm::dvec2(size_px) - 1.0;
  const glm::dvec2 high_px =
      (glm::clamp(cover.high, {-1.0, -1.0}, {1.0, 1.0}) * 0.5 + 0.5) * glm::dvec2(size_px) + 1.0;
  const glm::ivec2 last = size_px - 1;
  return {glm::clamp(glm::ivec2(glm::floor(low_px)), glm::ivec2(0), last) / tile_px,
          glm::clamp(glm::ivec2(glm::floor(high_px)), glm::ivec2(0), last) / tile_px};
}

std::vector<std::uint32_t> NearestFirst(const std::vector<Ball>& balls, const scene::View& view) {
  std::vector<double> away_m;
  for (const Ball& ball : balls) {
    const glm::dvec3 off_m = ball.middle_m - view.eye_m;
    away_m.push_back(view.Orthographic() ? glm::dot(off_m, view.forward) : glm::length(off_m));
  }
  std::vector<std::uint32_t> order(balls.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return away_m[a] < away_m[b]; });
  return order;
}

}  // namespace

BallTiles TilesOf(const std::vector<Ball>& balls, const scene::View& view,
                  const glm::ivec2& size_px) {
  std::vector<BallCover> covers;
  covers.reserve(balls.size());
  for (const Ball& ball : balls) covers.push_back(CoverOf(ball, view));
  BallTiles tiles;
  tiles.tile_px = kMinBallTile_px;
  std::vector<TileRange> ranges(balls.size());
  std::size_t listed = 0;
  while (true) {
    listed = 0;
    for (std::size_t i = 0; i < balls.size(); ++i) {
      ranges[i] = RangeOf(covers[i], size_px, tiles.tile_px);
      listed += ranges[i].Count();
    }
    if (listed <= kMaxListed || tiles.tile_px >= std::max(size_px.x, size_px.y)) break;
    tiles.tile_px *= 2;
  }
  tiles.tiles = (size_px + tiles.tile_px - 1) / tiles.tile_px;
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(tiles.tiles.x) +
           static_cast<std::size_t>(x);
  };
  const auto for_tiles = [&](const TileRange& range, const auto& visit) {
    for (int y = range.low.y; y <= range.high.y; ++y) {
      for (int x = range.low.x; x <= range.high.x; ++x) visit(at(x, y));
    }
  };
  tiles.starts.assign(at(0, tiles.tiles.y) + 1, 0);
  for (const TileRange& range : ranges) {
    for_tiles(range, [&](std::size_t tile) { ++tiles.starts[tile + 1]; });
  }
  std::partial_sum(tiles.starts.begin(), tiles.starts.end(), tiles.starts.begin());
  std::vector<std::uint32_t> next(tiles.starts.begin(), tiles.starts.end() - 1);
  tiles.balls.resize(listed);
  for (const std::uint32_t ball : NearestFirst(balls, view)) {
    for_tiles(ranges[ball], [&](std::size_t tile) { tiles.balls[next[tile]++] = ball; });
  }
  return tiles;
}

}  // namespace thunderhead::renderers
