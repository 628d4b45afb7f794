#include "measure/image_error.h"

#include <cmath>
#include <functional>

#include "gtest/gtest.h"

namespace thunderhead::measure {
namespace {

picture::LinearPicture Linear(const std::vector<float>& gray) {
  picture::LinearPicture image{{static_cast<int>(gray.size()), 1}, {}};
  for (const float value : gray) image.radiance.emplace_back(value);
  return image;
}

frame::RgbImage Drawn(const std::function<int(int x, int y)>& gray) {
  frame::RgbImage image{48, 40, {}};
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 48; ++x)
      image.rgb.insert(image.rgb.end(), 3, static_cast<std::uint8_t>(gray(x, y)));
  }
  return image;
}

TEST(ImageError, RelativeRmseAndBias) {
  const picture::LinearPicture reference = Linear({1.0F, 3.0F});
  EXPECT_EQ(RelativeRmse(reference, reference), 0.0);
  EXPECT_EQ(RelativeBias(reference, reference), 0.0);
  // The differences are 1 and -1, with a mean of 2.
  EXPECT_DOUBLE_EQ(RelativeRmse(Linear({2.0F, 2.0F}), reference), 0.5);
  EXPECT_DOUBLE_EQ(RelativeBias(Linear({2.0F, 2.0F}), reference), 0.0);
  EXPECT_DOUBLE_EQ(RelativeBias(Linear({1.5F, 3.5F}), reference), 0.25);
  picture::LinearPicture noisy = reference;
  noisy.standard_error = {glm::vec3(0.2F), glm::vec3(0.2F)};
  EXPECT_DOUBLE_EQ(RelativeNoise(noisy), 0.2F / 2.0);
}

TEST(ImageError, TheReferencesNoiseIsTakenOutInSquares) {
  const picture::LinearPicture reference = Linear({1.0F, 3.0F});
  const picture::LinearPicture image = Linear({2.0F, 2.0F});  // its relative error is 0.5
  EXPECT_NEAR(RelativeRmseWithout(0.3, image, reference), 0.4, 1e-12);
  EXPECT_EQ(RelativeRmseWithout(0.0, image, reference), RelativeRmse(image, reference));
  EXPECT_EQ(RelativeRmseWithout(0.6, image, reference), 0.0);
}

TEST(Flip, OfAPictureWithItselfIsZero) {
  const frame::RgbImage picture = Drawn([](int x, int y) { return (x * 7 + y * 13) % 256; });
  EXPECT_EQ(Flip(picture, picture), 0.0);
}

TEST(Flip, OfEvenGraysFollowsTheColourFormula) {
  // Without edges or points, the error is that of the colour pipeline alone. Black and white have a
  // HyAB distance of 100. Green and blue have the largest distance, which bounds the scale. Their
  // L* is 87.73 and 32.30. Their (a*, b*) times L* / 100 are (-75.6, 73.0) and (25.6, -34.8). The
  // largest distance is therefore 55.4 + 148.0 = 203.5.
  const double most = std::pow(203.5, 0.7);
  const double distance = std::pow(100.0, 0.7);
  const double expected = 0.95 + (distance - 0.4 * most) / (0.6 * most) * 0.05;
  EXPECT_NEAR(Flip(Drawn([](int, int) { return 0; }), Drawn([](int, int) { return 255; })),
              expected, 2e-3);
}

TEST(Flip, IsSymmetricAndGrowsWithTheDifference) {
  const frame::RgbImage reference = Drawn([](int x, int) { return 100 + x; });
  const auto shifted = [&](int by) { return Drawn([=](int x, int) { return 100 + x + by; }); };
  const double small = Flip(shifted(2), reference);
  const double large = Flip(shifted(40), reference);
  EXPECT_GT(small, 0.0);
  EXPECT_LT(small, large);
  EXPECT_LT(large, 1.0);
  EXPECT_DOUBLE_EQ(Flip(reference, shifted(40)), large);
}

TEST(Flip, FineNoiseIsForgivenAndANewEdgeIsNot) {
  const frame::RgbImage reference = Drawn([](int, int) { return 128; });
  // Both pictures change every pixel by 10 levels.
  const frame::RgbImage chequered =
      Drawn([](int x, int y) { return (x + y) % 2 == 0 ? 118 : 138; });
  const frame::RgbImage stepped = Drawn([](int x, int) { return x < 24 ? 118 : 138; });
  EXPECT_LT(2.0 * Flip(chequered, reference), Flip(stepped, reference));
}

}  // namespace
}  // namespace thunderhead::measure
