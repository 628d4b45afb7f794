#include "frame/jpeg_strips.h"

#include <algorithm>
#include <cstdint>

#include "frame/image_codec.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::frame {
namespace {

using testing::HasSubstr;

constexpr int kWidth_px = 41;  // the width of three units (the blocks that JPEG codes together)
constexpr int kUnits = 3;
constexpr int kRows_px = 16;
constexpr int kQuality = 90;

// Returns colours that differ everywhere, so that a strip in a wrong place is noticed.
std::vector<std::uint8_t> Waves(int width_px, int height_px) {
  std::vector<std::uint8_t> rgb;
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      rgb.push_back(static_cast<std::uint8_t>((7 * x + 3 * y) % 256));
      rgb.push_back(static_cast<std::uint8_t>(x * y % 251));
      rgb.push_back(static_cast<std::uint8_t>(11 * y % 256));
    }
  }
  return rgb;
}

std::string Encoded(int width_px, int height_px, absl::Span<const std::uint8_t> rgb) {
  const auto jpeg = EncodeJpeg(width_px, height_px, rgb, kQuality);
  return jpeg.ok() ? *jpeg : "";
}

std::vector<std::string> StripsOf(int height_px, const std::vector<std::uint8_t>& rgb) {
  std::vector<std::string> strips;
  for (int row = 0; row < height_px; row += kRows_px) {
    const int height = std::min(kRows_px, height_px - row);
    const auto first = static_cast<std::size_t>(row) * kWidth_px * 3;
    strips.push_back(Encoded(
        kWidth_px, height,
        absl::MakeConstSpan(rgb).subspan(first, static_cast<std::size_t>(height) * kWidth_px * 3)));
  }
  return strips;
}

// There are more strips than restart markers, and the last strip is lower.
TEST(JpegStrips, DecodeAsThePictureEncodedWhole) {
  constexpr int kHeight_px = 11 * kRows_px + 5;
  const std::vector<std::uint8_t> rgb = Waves(kWidth_px, kHeight_px);
  const auto joined = JoinJpegStrips(StripsOf(kHeight_px, rgb), kUnits, kHeight_px);
  ASSERT_TRUE(joined.ok()) << joined.status();
  const auto image = DecodeJpeg(*joined);
  const auto whole = DecodeJpeg(Encoded(kWidth_px, kHeight_px, rgb));
  ASSERT_TRUE(image.ok() && whole.ok()) << image.status();
  EXPECT_EQ(image->height_px, kHeight_px);
  EXPECT_EQ(image->rgb, whole->rgb);
}

TEST(JpegStrips, AStripThatIsNoJpegIsNamed) {
  std::vector<std::string> strips = StripsOf(2 * kRows_px, Waves(kWidth_px, 2 * kRows_px));
  strips[1].resize(strips[1].size() / 2);
  const auto joined = JoinJpegStrips(strips, kUnits, 2 * kRows_px);
  EXPECT_THAT(std::string(joined.status().message()), HasSubstr("strip 1"));
}

// Several threads encode the picture if there are several processors.
TEST(JpegStrips, ALargePictureIsTheSameAsItsParts) {
  constexpr int kSide_px = 1100;
  const std::vector<std::uint8_t> rgb = Waves(kSide_px, kSide_px);
  const auto image = DecodeJpeg(Encoded(kSide_px, kSide_px, rgb));
  ASSERT_TRUE(image.ok()) << image.status();
  // Compares parts of 160 rows that begin at a row of units. The rows next to a cut are left out,
  // because the decoder smooths them with their neighbours.
  for (const int first : {0, 320, 640}) {
    constexpr int kPart_px = 160;
    constexpr std::size_t kRow = std::size_t{kSide_px} * 3;
    const auto part = DecodeJpeg(Encoded(
        kSide_px, kPart_px,
        absl::MakeConstSpan(rgb).subspan(static_cast<std::size_t>(first) * kRow, kPart_px * kRow)));
    ASSERT_TRUE(part.ok());
    for (std::size_t i = 2 * kRow; i < (kPart_px - 2) * kRow; ++i) {
      ASSERT_EQ(part->rgb[i], image->rgb[static_cast<std::size_t>(first) * kRow + i])
          << first << " " << i;
    }
  }
}

}  // namespace
}  // namespace thunderhead::frame
