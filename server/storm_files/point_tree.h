// Finds the nearest of many points in a plane, in a k-d tree (Bentley 1975). This code is pure
// arithmetic and does not depend on files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "glm/vec2.hpp"

namespace thunderhead::storm_files {

class PointTree {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffU;

  // A point by its index among those that were given, and the square of its distance.
  struct Found {
    std::uint32_t point = kNone;
    double square = 0.0;
  };

  // There must be fewer than kNone points, with finite coordinates.
  explicit PointTree(const std::vector<glm::dvec2>& points);

  // Fills `found` with the points nearest to `at`, the nearest first. They are nearer than the
  // square root of `below_square`. If there are fewer such points, the last entries are kNone.
  void FindNearest(const glm::dvec2& at, double below_square, std::span<Found> found) const;

 private:
  struct Point {
    glm::dvec2 at;
    std::uint32_t index = 0;
  };

  void Sort(std::size_t low, std::size_t high, int axis);
  void Search(std::size_t low, std::size_t high, int axis, const glm::dvec2& at,
              std::span<Found> found) const;
  static void Offer(const Point& point, const glm::dvec2& at, std::span<Found> found);

  // The root of the points from `low` to `high` is the one half-way between. On its axis no point
  // before it has a larger coordinate, and no point after it a smaller one. The axis alternates
  // from level to level.
  std::vector<Point> points_;
};

}  // namespace thunderhead::storm_files
