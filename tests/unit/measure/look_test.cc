#include "measure/look.h"

#include <algorithm>

#include "gtest/gtest.h"
#include "scene/view.h"
#include "tests/support/slab.h"

namespace thunderhead::measure {
namespace {

constexpr int kSide_px = 48;

// A fixture with a tower 10 km high and 5 km wide, seen from the south.
class LookRegionsTest : public testing::Test {
 protected:
  int Count(double sun_azimuth_deg, Region region) {
    scene::Scene scene;
    scene.output = {kSide_px, kSide_px, 90};
    scene.sun = {sun_azimuth_deg, 20.0, 1.0};
    scene.camera = scene::OrbitCamera{{0.0, 0.0, 5000.0}, 180.0, 0.0, 40e3, 16.0};
    const auto fields = support::MakeSlab(5000.0, 10e3, 0.05);
    const std::vector<float> opacity(std::size_t{kSide_px} * kSide_px, opacity_);
    const std::vector<Region> regions = RegionsOf(scene, *fields, opacity);
    return static_cast<int>(std::count(regions.begin(), regions.end(), region));
  }

  float opacity_ = 1.0F;
};

TEST_F(LookRegionsTest, TheTowerIsWhereTheSunShinesOnIt) {
  const int facing = Count(180.0, Region::kTower);
  EXPECT_GT(facing, 300);
  EXPECT_EQ(Count(180.0, Region::kBase), 0);
  // The sun shines from the side. The lit region is a strip at the tower's edge, where the path
  // towards the sun inside the cloud is short enough not to count (measure/look.h).
  EXPECT_GT(Count(90.0, Region::kTower), 0);
  EXPECT_LT(Count(90.0, Region::kTower), facing / 2);
}

TEST_F(LookRegionsTest, TheBaseIsInShadow) {
  // The sun is behind the tower. The tower's top is an exception and counts as lit. The path from
  // there towards the sun soon leaves the cloud, and its first part does not count
  // (measure/look.h).
  EXPECT_LT(Count(0.0, Region::kTower), Count(180.0, Region::kTower) / 2);
  EXPECT_GT(Count(0.0, Region::kBase), 50);
}

TEST_F(LookRegionsTest, ThinPixelsAreNeither) {
  opacity_ = 0.9F;
  EXPECT_EQ(Count(180.0, Region::kTower), 0);
}

TEST(LookFigures, CountStops) {
  picture::LinearPicture picture;
  picture.size_px = {10, 30};
  std::vector<Region> regions;
  for (int i = 0; i < 300; ++i) {
    const bool tower = i < 100;
    const bool base = i >= 200;
    // The tower's radiance rises from 1 to 4 in equal steps of its logarithm.
    picture.radiance.emplace_back(tower  ? std::exp2(2.0F * static_cast<float>(i) / 99.0F)
                                  : base ? 0.25F
                                         : 0.125F);
    regions.push_back(tower ? Region::kTower : base ? Region::kBase : Region::kNeither);
  }
  const LookFigures figures = FiguresOf(regions, picture);
  EXPECT_EQ(figures.tower_pixels, 100);
  EXPECT_EQ(figures.base_pixels, 100);
  EXPECT_NEAR(*figures.tower_stops, 2.0 * 0.9, 0.03);
  EXPECT_NEAR(*figures.base_share, 0.25 / 2.0, 0.002);
  EXPECT_NEAR(figures.frame_stops, 5.0, 0.1);
}

TEST(LookFigures, ReadWhatAScreenShows) {
  frame::RgbImage display{20, 10, {}};
  std::vector<Region> regions(200, Region::kTower);
  for (int i = 0; i < 200; ++i) {
    // sRGB 188 is half of the light of 255.
    const std::uint8_t code = i < 100 ? 188 : 255;
    display.rgb.insert(display.rgb.end(), {code, code, code});
  }
  EXPECT_NEAR(*FiguresOf(regions, display).tower_stops, 1.0, 0.02);
  EXPECT_FALSE(FiguresOf(regions, display).base_share.has_value());
}

}  // namespace
}  // namespace thunderhead::measure
