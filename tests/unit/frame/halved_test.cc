#include "frame/halved.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::frame {
namespace {

using ::testing::ElementsAre;

TEST(Halved, EachPixelIsTheMeanOfFour) {
  const RgbImage image{2, 2, {0, 10, 20, 4, 10, 21, 8, 10, 22, 12, 10, 255}};
  const RgbImage half = Halved(image);
  EXPECT_EQ(half.width_px, 1);
  EXPECT_EQ(half.height_px, 1);
  EXPECT_THAT(half.rgb, ElementsAre(6, 10, 80));
}

TEST(Halved, OddEdgesAreMeansOfWhatIsThere) {
  const RgbImage image{3, 1, {0, 0, 0, 10, 10, 10, 200, 100, 50}};
  const RgbImage half = Halved(image);
  EXPECT_EQ(half.width_px, 2);
  EXPECT_EQ(half.height_px, 1);
  EXPECT_THAT(half.rgb, ElementsAre(5, 5, 5, 200, 100, 50));
}

}  // namespace
}  // namespace thunderhead::frame
