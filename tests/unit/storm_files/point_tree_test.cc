#include "storm_files/point_tree.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <random>

#include "glm/geometric.hpp"

// Tests are compiled together, and other tests have the same names.
namespace thunderhead::storm_files::point_tree_test {
namespace {

constexpr double kAnywhere = std::numeric_limits<double>::infinity();

std::vector<glm::dvec2> RandomPoints(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> anywhere(-1.0, 1.0);
  std::vector<glm::dvec2> points;
  for (int i = 0; i < count; ++i) points.emplace_back(anywhere(random), anywhere(random));
  return points;
}

// Returns the squares of the distances of all points, ascending.
std::vector<double> Squares(const std::vector<glm::dvec2>& points, const glm::dvec2& at) {
  std::vector<double> squares;
  for (const glm::dvec2& point : points) squares.push_back(glm::dot(point - at, point - at));
  std::ranges::sort(squares);
  return squares;
}

TEST(PointTree, FindsTheNearestPoints) {
  for (const int count : {1, 8, 9, 100, 1000}) {
    const std::vector<glm::dvec2> points = RandomPoints(count, 1);
    const PointTree tree(points);
    for (const glm::dvec2& at : RandomPoints(200, 2)) {
      const std::vector<double> squares = Squares(points, 1.5 * at);
      std::array<PointTree::Found, 4> found;
      tree.FindNearest(1.5 * at, kAnywhere, found);
      for (std::size_t i = 0; i < found.size(); ++i) {
        if (i >= points.size()) {
          EXPECT_EQ(found[i].point, PointTree::kNone);
          continue;
        }
        ASSERT_EQ(found[i].square, squares[i]) << count << " points, nearest " << i;
        const glm::dvec2 way = points[found[i].point] - 1.5 * at;
        ASSERT_EQ(found[i].square, glm::dot(way, way));
      }
    }
  }
}

TEST(PointTree, FindsOnlyPointsThatAreNearEnough) {
  const PointTree tree({{0.0, 0.0}, {3.0, 0.0}});
  std::array<PointTree::Found, 2> found;
  tree.FindNearest({1.0, 0.0}, 2.0, found);
  EXPECT_EQ(found[0].point, 0U);
  EXPECT_EQ(found[1].point, PointTree::kNone);
  tree.FindNearest({1.0, 0.0}, 0.5, found);
  EXPECT_EQ(found[0].point, PointTree::kNone);
}

TEST(PointTree, PointsMayCoincide) {
  const PointTree tree(std::vector<glm::dvec2>(100'000, glm::dvec2(2.0, 1.0)));
  std::array<PointTree::Found, 4> found;
  tree.FindNearest({2.0, 1.0}, kAnywhere, found);
  EXPECT_EQ(found[3].square, 0.0);
  EXPECT_NE(found[3].point, found[0].point);
}

}  // namespace
}  // namespace thunderhead::storm_files::point_tree_test
