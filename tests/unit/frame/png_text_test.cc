#include "frame/png_text.h"

#include <sys/resource.h>

#include "frame/image_codec.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::frame {
namespace {

using ::testing::HasSubstr;

long PeakMemory_kib() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return used.ru_maxrss;
}

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

// libpng would allocate memory of the length that a chunk says, up to 2 GiB.
TEST(PngText, ChunksThatSayToBeLongerThanTheFileTakeNoMemory) {
  const std::string png = WithTexts(Picture(), {{"Title", "storm"}});
  std::string longer = png;
  longer.replace(8 + 25, 4, std::string("\x7f\xff\xff\xff", 4));
  const long before_kib = PeakMemory_kib();
  EXPECT_THAT(std::string(TextsOf(longer).status().message()), HasSubstr("it is cut short"));
  EXPECT_LT(PeakMemory_kib() - before_kib, 1 << 20);
  EXPECT_FALSE(CheckPngChunks(longer).ok());
  EXPECT_TRUE(CheckPngChunks(png).ok());
}

TEST(PngText, TextsAreReadFromAPictureThatEndsWithinItsPixels) {
  const std::string png = WithTexts(Picture(), {{"Title", "storm"}});
  const std::string start = png.substr(0, png.find("IDAT") + 6);
  EXPECT_EQ(TextsOf(start).value().at("Title"), "storm");
}

}  // namespace
}  // namespace thunderhead::frame
