#include "volume/border_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "glm/gtc/packing.hpp"

namespace thunderhead::volume {
namespace {

constexpr int kNone = -1;
constexpr float kFar = std::numeric_limits<float>::max();
// Each texel up to this distance from a piece of a line is compared with that piece directly. The
// distance transform (Spread) handles texels farther away.
constexpr float kBeside_texels = 1.5F;

// A straight piece of a line, in texels.
struct Piece {
  glm::vec2 from{0.0F};
  glm::vec2 along{0.0F};
  float inverse_squared_length = 0.0F;
  float strength = 1.0F;

  // Returns the offset of a place from the nearest point of the piece.
  glm::vec2 Offset(const glm::vec2& place) const {
    const glm::vec2 off = place - from;
    const float share = std::clamp(glm::dot(off, along) * inverse_squared_length, 0.0F, 1.0F);
    return off - share * along;
  }
};

std::vector<Piece> PiecesOf(const std::vector<BorderLine>& lines, const BorderGrid& grid) {
  std::vector<Piece> pieces;
  const glm::vec2 size(grid.texels);
  for (const BorderLine& line : lines) {
    for (std::size_t i = 1; i < line.points_m.size(); ++i) {
      const glm::vec2 from((line.points_m[i - 1] - grid.low_m) / grid.texel_m);
      const glm::vec2 to((line.points_m[i] - grid.low_m) / grid.texel_m);
      const glm::vec2 low = glm::min(from, to);
      const glm::vec2 high = glm::max(from, to);
      if (high.x < 0.0F || high.y < 0.0F || low.x > size.x || low.y > size.y) continue;
      const glm::vec2 along = to - from;
      const float squared = glm::dot(along, along);
      pieces.push_back({from, along, squared > 0.0F ? 1.0F / squared : 0.0F, line.strength});
    }
  }
  return pieces;
}

// Finds the piece that is nearest to each texel's centre.
class Nearest {
 public:
  Nearest(std::span<const Piece> pieces, const glm::ivec2& texels)
      : pieces_(pieces),
        texels_(texels),
        piece_(static_cast<std::size_t>(texels.x) * static_cast<std::size_t>(texels.y), kNone),
        squared_(piece_.size(), kFar) {
    for (std::size_t i = 0; i < pieces.size(); ++i) TryBeside(static_cast<int>(i));
    Spread();
  }

  const Piece& Of(int x, int y) const {
    return pieces_[static_cast<std::size_t>(piece_[Index(x, y)])];
  }

  static glm::vec2 Middle(int x, int y) {
    return {static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F};
  }

 private:
  std::size_t Index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(texels_.x) +
           static_cast<std::size_t>(x);
  }

  void Try(int piece, int x, int y) {
    const std::size_t at = Index(x, y);
    if (piece == kNone || piece_[at] == piece) return;
    const glm::vec2 offset = pieces_[static_cast<std::size_t>(piece)].Offset(Middle(x, y));
    const float squared = glm::dot(offset, offset);
    if (squared >= squared_[at]) return;
    squared_[at] = squared;
    piece_[at] = piece;
  }

  void TryBeside(int piece) {
    const Piece& each = pieces_[static_cast<std::size_t>(piece)];
    const glm::vec2 to = each.from + each.along;
    const glm::ivec2 last = texels_ - 1;
    const auto held = [&](const glm::vec2& place) {
      return glm::ivec2(glm::clamp(glm::floor(place), glm::vec2(0.0F), glm::vec2(last)));
    };
    const glm::ivec2 low = held(glm::min(each.from, to) - kBeside_texels);
    const glm::ivec2 high = held(glm::max(each.from, to) + kBeside_texels);
    for (int y = low.y; y <= high.y; ++y) {
      for (int x = low.x; x <= high.x; ++x) Try(piece, x, y);
    }
  }

  void TryThatOf(int from_x, int from_y, int x, int y) {
    if (from_x < 0 || from_y < 0 || from_x >= texels_.x || from_y >= texels_.y) return;
    Try(piece_[Index(from_x, from_y)], x, y);
  }

  // Updates the nearest piece of each texel in row `y`. It tries the pieces that the texel's
  // neighbours have found, in the same row and in the next row in direction `from` (-1 or 1).
  void SpreadRow(int y, int from) {
    for (int x = 0; x < texels_.x; ++x) {
      for (int side = -1; side <= 1; ++side) TryThatOf(x + side, y + from, x, y);
      TryThatOf(x - 1, y, x, y);
    }
    for (int x = texels_.x - 1; x >= 0; --x) TryThatOf(x + 1, y, x, y);
  }

  // Applies Danielsson's distance transform (1980): one sweep over the rows upwards and one
  // downwards.
  void Spread() {
    for (int y = 0; y < texels_.y; ++y) SpreadRow(y, -1);
    for (int y = texels_.y - 1; y >= 0; --y) SpreadRow(y, 1);
  }

  std::span<const Piece> pieces_;
  glm::ivec2 texels_;
  std::vector<int> piece_;
  std::vector<float> squared_;
};

}  // namespace

BorderMap MakeBorderMap(const std::vector<BorderLine>& lines, const BorderGrid& grid) {
  BorderMap map{grid, {}};
  const std::vector<Piece> pieces = PiecesOf(lines, grid);
  if (pieces.empty()) return map;
  const Nearest nearest(pieces, grid.texels);
  const float fades = std::max(static_cast<float>(grid.fades_m / grid.texel_m), 1.0F);
  map.nearest.reserve(static_cast<std::size_t>(grid.texels.x) *
                      static_cast<std::size_t>(grid.texels.y));
  for (int y = 0; y < grid.texels.y; ++y) {
    for (int x = 0; x < grid.texels.x; ++x) {
      const Piece& piece = nearest.Of(x, y);
      const glm::vec2 offset = piece.Offset(Nearest::Middle(x, y));
      const int from_edge = std::min({x, y, grid.texels.x - 1 - x, grid.texels.y - 1 - y});
      const float there = std::min(static_cast<float>(from_edge) / fades, 1.0F);
      map.nearest.push_back(glm::packHalf4x16(
          glm::vec4(offset.x, offset.y, glm::length(offset), there * piece.strength)));
    }
  }
  return map;
}

glm::vec4 NearestBorder(const BorderMap& map, const glm::dvec2& place_m) {
  const glm::ivec2 texels = map.grid.texels;
  const glm::dvec2 place = (place_m - map.grid.low_m) / map.grid.texel_m - 0.5;
  const glm::dvec2 held = glm::clamp(place, glm::dvec2(0.0), glm::dvec2(texels - 1));
  const glm::ivec2 low(glm::floor(held));
  const glm::ivec2 high = glm::min(low + 1, texels - 1);
  const glm::vec2 share(held - glm::dvec2(low));
  const auto texel = [&](int x, int y) {
    return glm::unpackHalf4x16(
        map.nearest[static_cast<std::size_t>(y) * static_cast<std::size_t>(texels.x) +
                    static_cast<std::size_t>(x)]);
  };
  return glm::mix(glm::mix(texel(low.x, low.y), texel(high.x, low.y), share.x),
                  glm::mix(texel(low.x, high.y), texel(high.x, high.y), share.x), share.y);
}

}  // namespace thunderhead::volume
