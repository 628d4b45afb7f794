#include "frame/image_codec.h"

#include <cmath>
#include <cstdlib>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::frame {
namespace {

using ::testing::HasSubstr;

// Returns smooth ramps: red along x, green along y, blue along both.
std::vector<std::uint8_t> Ramps(int width_px, int height_px) {
  std::vector<std::uint8_t> rgb;
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      rgb.push_back(static_cast<std::uint8_t>(255 * x / width_px));
      rgb.push_back(static_cast<std::uint8_t>(255 * y / height_px));
      rgb.push_back(static_cast<std::uint8_t>(255 * (x + y) / (width_px + height_px)));
    }
  }
  return rgb;
}

double MeanError(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(int{a[i]} - int{b[i]});
  return sum / static_cast<double>(a.size());
}

TEST(ImageCodecTest, PngGivesBackEveryByte) {
  const auto rgb = Ramps(67, 41);
  const auto png = EncodePng(67, 41, rgb);
  ASSERT_TRUE(png.ok()) << png.status();
  EXPECT_EQ(png->substr(1, 3), "PNG");
  const auto image = DecodePng(*png);
  ASSERT_TRUE(image.ok()) << image.status();
  EXPECT_EQ(image->width_px, 67);
  EXPECT_EQ(image->height_px, 41);
  EXPECT_EQ(image->rgb, rgb);
}

TEST(ImageCodecTest, JpegGivesBackSmoothPicturesClosely) {
  const auto rgb = Ramps(160, 90);
  const auto jpeg = EncodeJpeg(160, 90, rgb, 95);
  ASSERT_TRUE(jpeg.ok()) << jpeg.status();
  const auto image = DecodeJpeg(*jpeg);
  ASSERT_TRUE(image.ok()) << image.status();
  ASSERT_EQ(image->width_px, 160);
  ASSERT_EQ(image->height_px, 90);
  // Quality 95 quantises by one to a few levels, and 4:2:0 halves the colour resolution of smooth
  // ramps.
  EXPECT_LT(MeanError(image->rgb, rgb), 3.0);
}

TEST(ImageCodecTest, LowerJpegQualityIsSmallerAndWorse) {
  const auto rgb = Ramps(160, 90);
  const auto fine = EncodeJpeg(160, 90, rgb, 95);
  const auto coarse = EncodeJpeg(160, 90, rgb, 10);
  ASSERT_TRUE(fine.ok() && coarse.ok());
  EXPECT_LT(coarse->size(), fine->size());
  EXPECT_GT(MeanError(DecodeJpeg(*coarse)->rgb, rgb), MeanError(DecodeJpeg(*fine)->rgb, rgb));
}

TEST(ImageCodecTest, OnePixelIsAPicture) {
  const std::vector<std::uint8_t> rgb = {10, 20, 30};
  EXPECT_EQ(DecodePng(*EncodePng(1, 1, rgb))->rgb, rgb);
  EXPECT_EQ(DecodeJpeg(*EncodeJpeg(1, 1, rgb, 100))->rgb.size(), 3U);
}

TEST(ImageCodecTest, WrongSizesAndQualitiesAreErrors) {
  const std::vector<std::uint8_t> rgb(12);
  EXPECT_THAT(std::string(EncodePng(2, 3, rgb).status().message()),
              HasSubstr("2 x 3 pixels needs 18 bytes, but 12 were given"));
  EXPECT_EQ(EncodeJpeg(0, 3, rgb, 80).status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(EncodeJpeg(70000, 1, rgb, 80).status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(EncodeJpeg(2, 2, rgb, 101).status().message()),
              HasSubstr("JPEG quality is 101"));
}

TEST(ImageCodecTest, BrokenFilesAreErrors) {
  EXPECT_FALSE(DecodePng("").ok());
  EXPECT_FALSE(DecodePng("not a picture").ok());
  EXPECT_FALSE(DecodeJpeg("").ok());
  EXPECT_FALSE(DecodeJpeg("not a picture").ok());
  const std::string png = *EncodePng(64, 64, Ramps(64, 64));
  EXPECT_FALSE(DecodePng(png.substr(0, png.size() / 2)).ok());
}

}  // namespace
}  // namespace thunderhead::frame
