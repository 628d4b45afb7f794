#include "frame/png_text.h"

#include "frame/image_codec.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::frame {
namespace {

using ::testing::HasSubstr;

std::string Picture() { return *EncodePng(2, 1, {{1, 2, 3, 4, 5, 6}}); }

TEST(PngText, TextsComeBackAndThePixelsStay) {
  const PngTexts texts = {{"Title",
                           "Gewitter \xc3\xbc"
                           "ber Oklahoma"},
                          {"thunderhead.scene", std::string(70'000, 'x')},
                          {"empty", ""}};
  const std::string png = WithTexts(Picture(), texts);
  const auto back = TextsOf(png);
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ(*back, texts);
  EXPECT_EQ(DecodePng(png)->rgb, DecodePng(Picture())->rgb);
  EXPECT_TRUE(TextsOf(Picture())->empty());
}

TEST(PngText, BytesThatAreNoPngAreRefused) {
  const std::string png = WithTexts(Picture(), {{"Title", "storm"}});
  EXPECT_TRUE(IsPng(png));
  EXPECT_FALSE(IsPng("{}"));
  EXPECT_EQ(TextsOf("{}").status().code(), absl::StatusCode::kInvalidArgument);
  for (std::size_t length = 0; length < 60; ++length) {
    EXPECT_THAT(std::string(TextsOf(png.substr(0, length)).status().message()),
                HasSubstr("not a PNG"))
        << length;
  }
  for (std::size_t at = 0; at < png.size(); ++at) {
    std::string broken = png;
    broken[at] ^= 0x40;
    (void)TextsOf(broken);  // must not crash, whatever the broken file contains
  }
}

}  // namespace
}  // namespace thunderhead::frame
