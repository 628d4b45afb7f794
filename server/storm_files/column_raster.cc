#include "storm_files/column_raster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <deque>
#include <optional>
#include <utility>

#include "glm/common.hpp"

namespace thunderhead::storm_files {
namespace {

double Cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

// A quadrilateral between four positions, as a bilinear map of two shares from 0 to 1.
struct Quad {
  glm::dvec2 origin;
  glm::dvec2 along_x;
  glm::dvec2 along_y;
  glm::dvec2 twist;

  // Returns the shares of a point, or nothing if it is outside.
  std::optional<glm::dvec2> SharesOf(const glm::dvec2& point) const {
    constexpr int kSteps = 6;  // of Newton's method, from the middle
    constexpr double kOutside = 1e-6;
    glm::dvec2 share(0.5);
    for (int i = 0; i < kSteps; ++i) {
      const glm::dvec2 off =
          origin + along_x * share.x + along_y * share.y + twist * share.x * share.y - point;
      const glm::dvec2 by_x = along_x + twist * share.y;
      const glm::dvec2 by_y = along_y + twist * share.x;
      const double area = Cross(by_x, by_y);
      if (area == 0.0) return std::nullopt;
      share -= glm::dvec2(Cross(off, by_y), Cross(by_x, off)) / area;
    }
    const double low = std::min(share.x, share.y);
    const double high = std::max(share.x, share.y);
    if (!(low >= -kOutside && high <= 1.0 + kOutside)) return std::nullopt;
    return glm::clamp(share, 0.0, 1.0);
  }
};

class Raster {
 public:
  Raster(const ColumnMesh& mesh, const EvenGrid& even)
      : mesh_(mesh),
        even_(even),
        from_(static_cast<std::size_t>(even.columns.x) * static_cast<std::size_t>(even.columns.y)) {
  }

  // Fills in the even columns between four neighbouring positions of the mesh.
  void Draw(int i, int j) {
    const std::array<glm::dvec2, 4> corners = {Cells(i, j), Cells(i + 1, j), Cells(i, j + 1),
                                               Cells(i + 1, j + 1)};
    glm::dvec2 low = corners[0];
    glm::dvec2 high = corners[0];
    for (const glm::dvec2& corner : corners) {
      low = glm::min(low, corner);
      high = glm::max(high, corner);
    }
    const Quad quad{corners[0], corners[1] - corners[0], corners[2] - corners[0],
                    corners[3] - corners[2] - corners[1] + corners[0]};
    constexpr double kMargin = 1e-6;
    const glm::ivec2 first = glm::max(glm::ivec2(glm::ceil(low - kMargin)), 0);
    const glm::ivec2 last = glm::min(glm::ivec2(glm::floor(high + kMargin)), even_.columns - 1);
    if (last.x < first.x || last.y < first.y) return;
    tried_ += static_cast<double>(last.x - first.x + 1) * (last.y - first.y + 1);
    if (IsScattered()) return;
    for (int y = first.y; y <= last.y; ++y) {
      for (int x = first.x; x <= last.x; ++x) {
        const std::optional<glm::dvec2> share = quad.SharesOf({x, y});
        if (share.has_value()) Set(x, y, {i, j}, *share);
      }
    }
  }

  // Gives columns outside the entry of the nearest column inside, ring by ring.
  void FillOutside() {
    std::deque<std::size_t> edge;
    std::vector<bool> known(from_.size());
    for (std::size_t at = 0; at < from_.size(); ++at) {
      known[at] = from_[at].inside;
      if (known[at]) edge.push_back(at);
    }
    const auto width = static_cast<std::size_t>(even_.columns.x);
    const auto spread = [&](std::size_t to, std::size_t source) {
      if (known[to]) return;
      known[to] = true;
      from_[to] = from_[source];
      from_[to].inside = false;
      edge.push_back(to);
    };
    for (; !edge.empty(); edge.pop_front()) {
      const std::size_t at = edge.front();
      if (at % width > 0) spread(at - 1, at);
      if (at % width + 1 < width) spread(at + 1, at);
      if (at >= width) spread(at - width, at);
      if (at + width < from_.size()) spread(at + width, at);
    }
  }

  // Returns whether the quadrilaterals of the mesh overlap many times. The mesh is then no grid,
  // and the search would take too long.
  bool IsScattered() const {
    constexpr double kMostOverlaps = 50.0;
    return tried_ > kMostOverlaps * static_cast<double>(from_.size());
  }
  bool AnyInside() const { return std::ranges::any_of(from_, &FromColumn::inside); }
  std::vector<FromColumn> Take() { return std::move(from_); }

 private:
  // Returns a position of the mesh in even columns.
  glm::dvec2 Cells(int i, int j) const {
    return (mesh_.At(i, j) - even_.first_m) / even_.spacing_m;
  }

  void Set(int x, int y, const glm::ivec2& quad, const glm::dvec2& share) {
    glm::ivec2 low(0);
    glm::dvec2 part(0.0);
    for (int axis = 0; axis < 2; ++axis) {
      const int count = mesh_.columns[axis];
      const double from = ColumnMesh::PositionOf(quad[axis], count);
      const double to = ColumnMesh::PositionOf(quad[axis] + 1, count);
      // In the outer half of an outermost column the value is that of its centre.
      const double position = std::clamp(from + share[axis] * (to - from), 0.0, count - 1.0);
      low[axis] = std::clamp(static_cast<int>(position), 0, std::max(count - 2, 0));
      part[axis] = position - low[axis];
    }
    FromColumn& entry =
        from_[static_cast<std::size_t>(y) * static_cast<std::size_t>(even_.columns.x) +
              static_cast<std::size_t>(x)];
    entry.south_west =
        static_cast<std::uint32_t>(low.y) * static_cast<std::uint32_t>(mesh_.columns.x) +
        static_cast<std::uint32_t>(low.x);
    entry.east = static_cast<float>(part.x);
    entry.north = static_cast<float>(part.y);
    entry.inside = true;
  }

  const ColumnMesh& mesh_;
  const EvenGrid& even_;
  std::vector<FromColumn> from_;
  double tried_ = 0.0;  // number of even columns that were tried
};

}  // namespace

double ColumnMesh::PositionOf(int i, int count) { return std::clamp(i - 1.0, -0.5, count - 0.5); }

std::vector<FromColumn> PlacesAmong(const ColumnMesh& mesh, const EvenGrid& even) {
  Raster raster(mesh, even);
  for (int j = 0; j <= mesh.columns.y; ++j) {
    for (int i = 0; i <= mesh.columns.x; ++i) raster.Draw(i, j);
  }
  if (raster.IsScattered() || !raster.AnyInside()) return {};
  raster.FillOutside();
  return raster.Take();
}

std::vector<float> AreasOf(const ColumnMesh& mesh, double unit_m2) {
  std::vector<float> areas;
  areas.reserve(static_cast<std::size_t>(mesh.columns.x) *
                static_cast<std::size_t>(mesh.columns.y));
  // The distance in columns between the positions on both sides of column `i`.
  const auto span = [](int i, int count) {
    return ColumnMesh::PositionOf(i + 2, count) - ColumnMesh::PositionOf(i, count);
  };
  for (int y = 0; y < mesh.columns.y; ++y) {
    for (int x = 0; x < mesh.columns.x; ++x) {
      const glm::dvec2 by_x = (mesh.At(x + 2, y + 1) - mesh.At(x, y + 1)) / span(x, mesh.columns.x);
      const glm::dvec2 by_y = (mesh.At(x + 1, y + 2) - mesh.At(x + 1, y)) / span(y, mesh.columns.y);
      areas.push_back(static_cast<float>(std::abs(Cross(by_x, by_y)) / unit_m2));
    }
  }
  return areas;
}

}  // namespace thunderhead::storm_files
