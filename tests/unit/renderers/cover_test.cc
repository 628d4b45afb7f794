#include "renderers/cover.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "glm/vector_relational.hpp"
#include "gtest/gtest.h"
#include "renderers/half_angle/slice_reach.h"

namespace thunderhead::renderers {
namespace {

constexpr glm::ivec2 kSize_px(301, 157);

// Returns boxes like those of a storm: next to, above and behind one another, around the origin.
Boxes SomeBoxes(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> across(-40e3, 40e3);
  std::uniform_real_distribution<double> up(0.0, 14e3);
  Boxes boxes{{}, {1e3, 1.2e3, 700.0}};
  for (int i = 0; i < count; ++i) {
    boxes.middles_m.emplace_back(across(random), across(random), up(random));
  }
  return boxes;
}

std::vector<scene::View> Views() {
  const double aspect = static_cast<double>(kSize_px.x) / kSize_px.y;
  std::vector<scene::View> views;
  for (const double distance_m : {20e3, 60e3, 300e3}) {
    scene::OrbitCamera orbit;
    orbit.target_m = {2e3, -1e3, 6e3};
    orbit.azimuth_deg = 200.0;
    orbit.elevation_deg = 12.0;
    orbit.distance_m = distance_m;
    views.push_back(scene::ViewOf(orbit, aspect));
  }
  scene::TopDownCamera top_down;
  top_down.center_m = {3e3, 4e3};
  top_down.width_m = 50e3;
  views.push_back(scene::ViewOf(top_down, aspect));
  return views;
}

// Returns the pixel coordinates of a point. They lie outside the picture if the picture does not
// show the point.
glm::dvec2 PixelOf(const glm::dvec3& point_m, const scene::View& view) {
  const glm::dvec3 off_m = point_m - view.eye_m;
  const double forward_m = glm::dot(off_m, view.forward);
  if (!view.Orthographic() && forward_m <= 0.0) return {-1e9, -1e9};
  const glm::dvec2 half_m(view.half_width_m + view.tan_half_width * forward_m,
                          view.half_height_m + view.tan_half_height * forward_m);
  const glm::dvec2 place =
      glm::dvec2(glm::dot(off_m, view.right), glm::dot(off_m, view.up)) / half_m;
  return (0.5 * place + 0.5) * glm::dvec2(kSize_px);
}

bool Holds(const PixelRect& rect, const glm::dvec2& pixel) {
  return pixel.x >= rect.low.x && pixel.y >= rect.low.y && pixel.x <= rect.high.x &&
         pixel.y <= rect.high.y;
}

bool InPicture(const glm::dvec2& pixel) { return Holds({glm::ivec2(0), kSize_px}, pixel); }

class Points {
 public:
  explicit Points(const Boxes& boxes) : boxes_(boxes) {}
  glm::dvec3 In(std::size_t box) {
    return boxes_.middles_m[box] +
           boxes_.half_extent_m * glm::dvec3(side_(random_), side_(random_), side_(random_));
  }

 private:
  const Boxes& boxes_;
  std::mt19937 random_{7};
  std::uniform_real_distribution<double> side_{-1.0, 1.0};
};

TEST(Cover, HoldsEveryPointOfEveryBox) {
  const Boxes boxes = SomeBoxes(40, 1);
  Points points(boxes);
  int seen = 0;
  for (const scene::View& view : Views()) {
    const std::vector<PixelRect> rects = CoveredRects(boxes, view, kSize_px, 0.0);
    for (int i = 0; i < 4000; ++i) {
      const glm::dvec2 pixel = PixelOf(points.In(static_cast<std::size_t>(i) % 40), view);
      if (!InPicture(pixel)) continue;
      ++seen;
      EXPECT_TRUE(std::any_of(rects.begin(), rects.end(),
                              [&](const PixelRect& rect) { return Holds(rect, pixel); }));
    }
  }
  EXPECT_GT(seen, 4000);
}

TEST(Cover, RectsDoNotOverlapNorLeaveThePicture) {
  const Boxes boxes = SomeBoxes(40, 2);
  for (const scene::View& view : Views()) {
    std::vector<int> drawn(static_cast<std::size_t>(kSize_px.x * kSize_px.y), 0);
    for (const PixelRect& rect : CoveredRects(boxes, view, kSize_px, 1.0)) {
      ASSERT_GE(rect.low.x, 0);
      ASSERT_GE(rect.low.y, 0);
      ASSERT_LE(rect.high.x, kSize_px.x);
      ASSERT_LE(rect.high.y, kSize_px.y);
      for (int y = rect.low.y; y < rect.high.y; ++y) {
        for (int x = rect.low.x; x < rect.high.x; ++x) {
          ++drawn[static_cast<std::size_t>(y * kSize_px.x + x)];
        }
      }
    }
    EXPECT_LE(*std::max_element(drawn.begin(), drawn.end()), 1);
  }
}

TEST(Cover, LeavesOutWhatHoldsNothing) {
  Boxes one{{{0.0, 0.0, 6e3}}, {500.0, 500.0, 500.0}};
  scene::OrbitCamera orbit;
  orbit.target_m = {0.0, 0.0, 6e3};
  orbit.distance_m = 100e3;
  const scene::View view = scene::ViewOf(orbit, 2.0);
  const std::vector<PixelRect> rects = CoveredRects(one, view, {800, 400}, 1.0);
  int pixels = 0;
  for (const PixelRect& rect : rects) {
    pixels += (rect.high.x - rect.low.x) * (rect.high.y - rect.low.y);
  }
  EXPECT_GT(pixels, 0);
  EXPECT_LE(pixels, 32 * 32);
  // The box is now behind the camera.
  one.middles_m[0] = view.eye_m - 10e3 * view.forward;
  EXPECT_TRUE(CoveredRects(one, view, {800, 400}, 1.0).empty());
  EXPECT_TRUE(CoveredRects({}, view, {800, 400}, 1.0).empty());
}

TEST(Cover, IsWholeForAnEyeAmongTheBoxes) {
  const scene::View view = Views().front();
  const Boxes around{{view.eye_m}, {500.0, 500.0, 500.0}};
  int pixels = 0;
  for (const PixelRect& rect : CoveredRects(around, view, kSize_px, 0.0)) {
    pixels += (rect.high.x - rect.low.x) * (rect.high.y - rect.low.y);
  }
  EXPECT_EQ(pixels, kSize_px.x * kSize_px.y);
}

TEST(SliceReach, HoldsWhatEachSliceCutsOfTheBoxes) {
  const Boxes boxes = SomeBoxes(40, 3);
  const glm::dvec3 middle_m(1e3, 2e3, 7e3);
  const LocalBox box{{42e3, 43e3, 8e3}};
  const glm::dvec3 towards_sun = scene::Direction(120.0, 35.0);
  const LightFrame frame = LightFrameOf(box, towards_sun);
  const glm::ivec2 texels(90, 70);
  Points points(boxes);
  int in_picture = 0;
  for (const scene::View& view : Views()) {
    const Slicing slicing = SliceBox(box, towards_sun, -view.forward, 64);
    const std::vector<SliceReach> reach =
        ReachOf(slicing, boxes, middle_m, view, kSize_px, frame, texels);
    ASSERT_EQ(reach.size(), 64U);
    for (int i = 0; i < 4000; ++i) {
      const auto at = static_cast<std::size_t>(i) % boxes.middles_m.size();
      glm::dvec3 point_m = points.In(at);
      // Moves the point onto the nearest slice, if that slice cuts the box.
      const double along_m = glm::dot(slicing.normal, point_m - middle_m);
      const double place = (slicing.first_m - along_m) / slicing.spacing_m;
      const double slice = std::round(place);
      if (slice < 0.0 || slice > 63.0) continue;
      point_m += (place - slice) * slicing.spacing_m * slicing.normal;
      if (glm::any(
              glm::greaterThan(glm::abs(point_m - boxes.middles_m[at]), boxes.half_extent_m))) {
        continue;
      }
      const SliceReach& reached = reach[static_cast<std::size_t>(slice)];
      const glm::dvec2 across_m(glm::dot(point_m - middle_m, frame.right),
                                glm::dot(point_m - middle_m, frame.up));
      const glm::dvec2 texel = (0.5 * across_m / frame.half_extent_m + 0.5) * glm::dvec2(texels);
      EXPECT_TRUE(Holds(reached.light, texel)) << slice;
      const glm::dvec2 pixel = PixelOf(point_m, view);
      if (!InPicture(pixel)) continue;
      ++in_picture;
      EXPECT_TRUE(Holds(reached.eye, pixel)) << slice;
    }
  }
  EXPECT_GT(in_picture, 1000);
}

TEST(SliceReach, IsEmptyWhereASliceCutsNothing) {
  const Boxes low{{{0.0, 0.0, -5e3}}, {500.0, 500.0, 500.0}};
  const LocalBox box{{10e3, 10e3, 10e3}};
  const glm::dvec3 up(0.0, 0.0, 1.0);
  const Slicing slicing = SliceBox(box, up, up, 20);
  const std::vector<SliceReach> reach = ReachOf(slicing, low, glm::dvec3(0.0), Views().back(),
                                                kSize_px, LightFrameOf(box, up), {20, 20});
  for (std::size_t i = 0; i < reach.size(); ++i) {
    // Slices are 1 km apart from 9.5 km down. The box lies around the slice at -5.5 or -4.5 km.
    const bool cuts = std::abs(slicing.Distance_m(static_cast<int>(i)) + 5e3) <= 500.0;
    EXPECT_EQ(reach[i].light.Empty(), !cuts) << i;
  }
}

}  // namespace
}  // namespace thunderhead::renderers
