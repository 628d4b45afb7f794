#include "codec/avif.h"

#include <cmath>
#include <cstdlib>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::codec {
namespace {

// Returns a gradient from 0.25 to 0.5 whose steps are far finer than 8 bits.
frame::FineImage FineGradient(int width_px, int height_px) {
  frame::FineImage image{width_px, height_px, {}};
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      const double value = 65535.0 * (0.25 + 0.25 * x / width_px);
      for (const double share : {0.6, 0.8, 1.0}) {
        image.rgb.push_back(static_cast<std::uint16_t>(share * value));
      }
    }
  }
  return image;
}

TEST(Avif, KeepsWhatEightBitsLose) {
  const frame::FineImage image = FineGradient(256, 64);
  const auto avif = EncodeAvif(image);
  ASSERT_TRUE(avif.ok()) << avif.status();
  const auto decoded = DecodeAvif(*avif);
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  ASSERT_EQ(decoded->width_px, 256);
  ASSERT_EQ(decoded->height_px, 64);
  double sum = 0.0;
  for (std::size_t i = 0; i < image.rgb.size(); ++i) {
    sum += std::pow((static_cast<double>(decoded->rgb[i]) - image.rgb[i]) / 257.0, 2);
  }
  // The root mean square error is in units of 1/255. Rounding to 8 bits alone, without compression,
  // gives 0.289.
  EXPECT_LT(std::sqrt(sum / static_cast<double>(image.rgb.size())), 0.28);
}

TEST(Avif, BadPicturesAreRefused) {
  EXPECT_FALSE(EncodeAvif({2, 2, {1, 2, 3}}).ok());
  EXPECT_FALSE(EncodeAvif({}).ok());
  EXPECT_FALSE(DecodeAvif("no picture").ok());
}

}  // namespace
}  // namespace thunderhead::codec
