// Tests that marks are split into strokes. The web page makes such marks: lines, arrows and words
// of several strokes.
#include "desktop/mark_strokes.h"

#include <utility>

#include "gtest/gtest.h"

namespace thunderhead::desktop {
namespace {

// Returns a view from above in which one metre is half the picture's width.
v1::View FromAbove() {
  v1::View view;
  view.mutable_eye()->set_z_m(1000.0F);
  view.mutable_forward()->set_z(-1.0F);
  view.mutable_right()->set_x(1.0F);
  view.mutable_up()->set_y(1.0F);
  view.set_parallel(true);
  return view;
}

std::vector<MarkStroke> Strokes(const std::vector<std::pair<float, float>>& corners_m) {
  v1::Mark mark;
  for (const auto& [x, y] : corners_m) {
    mark.add_positions()->set_x_m(x);
    mark.mutable_positions()->rbegin()->set_y_m(y);
  }
  return StrokesOf(mark, FromAbove());
}

TEST(MarkStrokes, ARepeatedCornerLiftsThePen) {
  // This is an arrow: its shaft, then its head from one barb over the tip to the other.
  const auto strokes = Strokes({{0, 0}, {1, 0}, {1, 0}, {0.8F, 0.1F}, {1, 0}, {0.8F, -0.1F}});
  ASSERT_EQ(strokes.size(), 2U);
  ASSERT_EQ(strokes[0].points.size(), 2U);
  EXPECT_NEAR(strokes[0].points[1].x, 1.0, 1e-9);
  ASSERT_EQ(strokes[1].points.size(), 3U);
  EXPECT_NEAR(strokes[1].points[0].x, 0.8, 1e-6);
  EXPECT_FALSE(strokes[0].ink);
  EXPECT_FALSE(strokes[1].ink);
}

TEST(MarkStrokes, ALineByHandIsOfInkAndAStraightOneIsNot) {
  const auto line = Strokes({{0, 0}, {0.1F, 0.2F}, {0.3F, 0.2F}, {0.5F, 0.1F}, {0.7F, 0.4F}});
  ASSERT_EQ(line.size(), 1U);
  EXPECT_TRUE(line[0].ink);
  EXPECT_EQ(line[0].points.size(), 5U);
  const auto straight = Strokes({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  ASSERT_EQ(straight.size(), 1U);
  EXPECT_FALSE(straight[0].ink);
}

TEST(MarkStrokes, APointIsNone) {
  EXPECT_TRUE(Strokes({{0, 0}}).empty());
  EXPECT_TRUE(Strokes({{0, 0}, {0, 0}, {0, 0}}).empty());
  EXPECT_TRUE(Strokes({}).empty());
}

}  // namespace
}  // namespace thunderhead::desktop
