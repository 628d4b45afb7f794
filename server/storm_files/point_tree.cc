#include "storm_files/point_tree.h"

#include <algorithm>

#include "glm/geometric.hpp"

namespace thunderhead::storm_files {
namespace {

// Up to this many points are not sorted, but searched one by one.
constexpr std::size_t kLeaf = 8;

}  // namespace

PointTree::PointTree(const std::vector<glm::dvec2>& points) {
  points_.reserve(points.size());
  for (const glm::dvec2& at : points) {
    points_.push_back({at, static_cast<std::uint32_t>(points_.size())});
  }
  Sort(0, points_.size(), 0);
}

void PointTree::Sort(std::size_t low, std::size_t high, int axis) {
  if (high - low <= kLeaf) return;
  const std::size_t middle = low + (high - low) / 2;
  const auto at = [this](std::size_t i) {
    return points_.begin() + static_cast<std::ptrdiff_t>(i);
  };
  std::nth_element(at(low), at(middle), at(high),
                   [axis](const Point& a, const Point& b) { return a.at[axis] < b.at[axis]; });
  Sort(low, middle, 1 - axis);
  Sort(middle + 1, high, 1 - axis);
}

// Inserts a point among those found, if it is nearer than the last.
void PointTree::Offer(const Point& point, const glm::dvec2& at, std::span<Found> found) {
  const glm::dvec2 way = point.at - at;
  const double square = glm::dot(way, way);
  if (!(square < found.back().square)) return;
  std::size_t place = found.size() - 1;
  for (; place > 0 && square < found[place - 1].square; --place) found[place] = found[place - 1];
  found[place] = {point.index, square};
}

void PointTree::Search(std::size_t low, std::size_t high, int axis, const glm::dvec2& at,
                       std::span<Found> found) const {
  if (high - low <= kLeaf) {
    for (std::size_t i = low; i < high; ++i) Offer(points_[i], at, found);
    return;
  }
  const std::size_t middle = low + (high - low) / 2;
  const double beyond = at[axis] - points_[middle].at[axis];
  const bool is_low = beyond < 0.0;
  Search(is_low ? low : middle + 1, is_low ? middle : high, 1 - axis, at, found);
  if (!(beyond * beyond < found.back().square)) return;
  Offer(points_[middle], at, found);
  Search(is_low ? middle + 1 : low, is_low ? high : middle, 1 - axis, at, found);
}

void PointTree::FindNearest(const glm::dvec2& at, double below_square,
                            std::span<Found> found) const {
  std::ranges::fill(found, Found{kNone, below_square});
  Search(0, points_.size(), 0, at, found);
}

}  // namespace thunderhead::storm_files
