// Tests that the comparison of golden pictures tolerates rounding and nothing else.
#include "tests/golden/picture_difference.h"

#include "gtest/gtest.h"

namespace thunderhead::golden {
namespace {

constexpr int kWidth_px = 320;
constexpr int kHeight_px = 200;

// A fixture with a grey picture. `Change` adds to each value of the middle third of its width,
// where a storm would be.
class PictureDifferenceTest : public testing::Test {
 protected:
  static frame::RgbImage Grey() {
    frame::RgbImage image;
    image.width_px = kWidth_px;
    image.height_px = kHeight_px;
    image.rgb.assign(std::size_t{3} * kWidth_px * kHeight_px, 120);
    return image;
  }

  template <typename Change>
  static PictureDifference Changed(const Change& change) {
    frame::RgbImage image = Grey();
    for (int y = 0; y < kHeight_px; ++y) {
      for (int x = kWidth_px / 3; x < 2 * kWidth_px / 3; ++x) {
        for (int color = 0; color < 3; ++color) {
          image.rgb[static_cast<std::size_t>(3 * (y * kWidth_px + x) + color)] +=
              static_cast<std::uint8_t>(change(x, y, color));
        }
      }
    }
    return Difference(Grey(), image);
  }
};

TEST_F(PictureDifferenceTest, ThePictureItselfIsTheSame) {
  const PictureDifference difference = Changed([](int, int, int) { return 0; });
  EXPECT_EQ(difference.mean_step, 0.0);
  EXPECT_EQ(difference.worst_shift, 0.0);
  EXPECT_TRUE(IsTheSame(difference));
}

TEST_F(PictureDifferenceTest, AStormThatIsHalfAStepBrighterIsAnotherPicture) {
  const PictureDifference difference = Changed([](int x, int y, int) { return (x + y) % 2; });
  EXPECT_LT(difference.mean_step, 0.25) << "over the whole picture that is little";
  EXPECT_NEAR(difference.worst_shift, 0.5, 1e-12);
  EXPECT_FALSE(IsTheSame(difference));
}

TEST_F(PictureDifferenceTest, AColorThatIsHalfAStepDarkerIsAnotherPicture) {
  EXPECT_FALSE(
      IsTheSame(Changed([](int x, int y, int color) { return color == 2 ? -((x + y) % 2) : 0; })));
}

TEST_F(PictureDifferenceTest, RoundingBothWaysIsTheSame) {
  EXPECT_TRUE(IsTheSame(Changed([](int x, int y, int) { return (x + y) % 2 == 0 ? 1 : -1; })));
}

TEST_F(PictureDifferenceTest, OneEdgeMayMoveButNotMany) {
  EXPECT_TRUE(IsTheSame(Changed([](int x, int, int) { return x == 160 ? 6 : 0; })));
  EXPECT_FALSE(IsTheSame(Changed([](int x, int, int) { return x % 8 == 0 ? 6 : 0; })));
  EXPECT_FALSE(IsTheSame(Changed([](int x, int, int) { return x == 160 ? 30 : 0; })));
}

}  // namespace
}  // namespace thunderhead::golden
