// Tests of the annotations of pictures. The tests recognise an annotation by the pixels that it
// changes.
#include "product/annotation.h"

#include <algorithm>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "product/cairo_surface.h"
#include "product/logo.h"

namespace thunderhead::product {
namespace {

using ::testing::HasSubstr;

constexpr int kWidth_px = 640;
constexpr int kHeight_px = 360;
constexpr int kGrey = 128;

// A box of pixels, excluding `right` and `bottom`.
struct Box {
  int left = 0, top = 0, right = 0, bottom = 0;
};
constexpr Box kUpperLeft{0, 0, 300, 50};
constexpr Box kUpperRight{400, 0, kWidth_px, 80};
constexpr Box kLowerLeft{0, 320, 300, kHeight_px};
constexpr Box kLowerRight{400, 250, kWidth_px, kHeight_px};
constexpr Box kMiddle{0, 100, kWidth_px, 250};

frame::RgbImage Grey() {
  return {kWidth_px, kHeight_px,
          std::vector<std::uint8_t>(std::size_t{3} * kWidth_px * kHeight_px, kGrey)};
}

frame::RgbImage Annotated(const Annotation& annotation) {
  frame::RgbImage image = Grey();
  EXPECT_TRUE(Annotate(annotation, image).ok());
  return image;
}

std::vector<std::uint8_t> Pixels(const frame::RgbImage& image, const Box& box) {
  std::vector<std::uint8_t> pixels;
  for (int y = box.top; y < box.bottom; ++y) {
    const auto row = image.rgb.begin() + std::ptrdiff_t{3} * (y * image.width_px + box.left);
    pixels.insert(pixels.end(), row, row + std::ptrdiff_t{3} * (box.right - box.left));
  }
  return pixels;
}

int Changed(const frame::RgbImage& image, const Box& box) {
  const std::vector<std::uint8_t> pixels = Pixels(image, box);
  return static_cast<int>(std::ranges::count_if(pixels, [](int v) { return v != kGrey; }) / 3);
}

// Returns the number of pixels of almost that colour.
int Colored(const frame::RgbImage& image, const Box& box, int red, int green, int blue) {
  const std::vector<std::uint8_t> pixels = Pixels(image, box);
  int count = 0;
  for (std::size_t i = 0; i < pixels.size(); i += 3) {
    if (std::abs(pixels[i] - red) < 8 && std::abs(pixels[i + 1] - green) < 8 &&
        std::abs(pixels[i + 2] - blue) < 8) {
      ++count;
    }
  }
  return count;
}

// Returns the number of almost white pixels. Thin letters are almost white only at their widest
// places.
int Bright(const frame::RgbImage& image, const Box& box) {
  const std::vector<std::uint8_t> pixels = Pixels(image, box);
  int count = 0;
  for (std::size_t i = 0; i < pixels.size(); i += 3) {
    if (std::min({pixels[i], pixels[i + 1], pixels[i + 2]}) > 200) ++count;
  }
  return count;
}

// Returns a red picture whose left half is transparent.
std::string LogoPng(int width_px, int height_px) {
  const CairoSurface surface(cairo_image_surface_create(CAIRO_FORMAT_ARGB32, width_px, height_px));
  const CairoContext context(cairo_create(surface.get()));
  cairo_set_source_rgb(context.get(), 1.0, 0.0, 0.0);
  const int transparent_px = width_px / 2;
  cairo_rectangle(context.get(), transparent_px, 0, width_px - transparent_px, height_px);
  cairo_fill(context.get());
  std::string png;
  cairo_surface_write_to_png_stream(
      surface.get(),
      [](void* to, const unsigned char* bytes, unsigned int count) {
        static_cast<std::string*>(to)->append(reinterpret_cast<const char*>(bytes), count);
        return CAIRO_STATUS_SUCCESS;
      },
      &png);
  return png;
}

TEST(Annotation, EachTextIsInItsCornerAndNowhereElse) {
  const frame::RgbImage image =
      Annotated({.title = "Supercell", .run = "run 2013-05-20 12:00Z", .valid_time = "2013"});
  EXPECT_GT(Changed(image, kUpperLeft), 300);
  EXPECT_GT(Changed(image, kLowerLeft), 50);
  EXPECT_EQ(Changed(image, kUpperRight), 0);
  EXPECT_EQ(Changed(image, kLowerRight), 0);
  EXPECT_EQ(Changed(image, kMiddle), 0);
  EXPECT_GT(Bright(image, kUpperLeft), 100) << "white";
  EXPECT_GT(Colored(image, kUpperLeft, 51, 51, 51), 100) << "with a dark edge";
}

TEST(Annotation, NothingToSayChangesNothing) { EXPECT_EQ(Annotated({}).rgb, Grey().rgb); }

TEST(Annotation, OtherTextsAreOtherPixelsInTheirOwnCornerAlone) {
  const frame::RgbImage first = Annotated({.title = "A", .run = "B", .valid_time = "20:10Z"});
  const frame::RgbImage other = Annotated({.title = "A", .run = "B", .valid_time = "20:20Z"});
  EXPECT_EQ(Pixels(first, kUpperLeft), Pixels(other, kUpperLeft));
  EXPECT_NE(Pixels(first, kLowerLeft), Pixels(other, kLowerLeft));
  const frame::RgbImage again = Annotated({.title = "A", .run = "B", .valid_time = "20:10Z"});
  EXPECT_EQ(first.rgb, again.rgb) << "the same text twice";
}

TEST(Annotation, LettersOfOtherScriptsAreShaped) {
  const frame::RgbImage name = Annotated({.title = "Gewitter über Θεσσαλονίκη"});
  const frame::RgbImage plain = Annotated({.title = "Gewitter uber Thessaloniki"});
  EXPECT_NE(Pixels(name, kUpperLeft), Pixels(plain, kUpperLeft));
  // Bytes that are not UTF-8, as in a file's attribute, do no harm.
  EXPECT_GT(Changed(Annotated({.title = "G\xfc\xff"}), kUpperLeft), 20);
}

TEST(Annotation, ALongTitleEndsBeforeTheEdgeAndTheLogo) {
  const auto logo = Logo::Decode(LogoPng(40, 40), "the test's");
  ASSERT_TRUE(logo.ok());
  const frame::RgbImage image = Annotated({.title = std::string(300, 'W'), .logo = &*logo});
  EXPECT_GT(Changed(image, {500, 0, 540, 30}), 100) << "as far as there is room";
  EXPECT_EQ(Changed(image, {kWidth_px - 7, 0, kWidth_px, kHeight_px}), 0) << "a margin";
  EXPECT_EQ(Colored(image, kUpperRight, 255, 0, 0), 20 * 40) << "the logo, on its own";
}

TEST(Annotation, ALogoIsInTheUpperRightAndNeverLarge) {
  const auto logo = Logo::Decode(LogoPng(1000, 1000), "the test's");
  ASSERT_TRUE(logo.ok()) << logo.status();
  const frame::RgbImage image = Annotated({.logo = &*logo});
  // The logo is a sixth of the height, and half of it is transparent.
  EXPECT_NEAR(Colored(image, kUpperRight, 255, 0, 0), 30 * 60, 150);
  EXPECT_EQ(Changed(image, {0, 0, 570, kHeight_px}), 0);
  EXPECT_EQ(Changed(image, {0, 70, kWidth_px, kHeight_px}), 0);
}

TEST(Annotation, TheLegendHasEachColourWithItsName) {
  const frame::RgbImage image =
      Annotated({.legend = {{"cloud", {1.0F, 0.0F, 0.0F}}, {"graupel", {0.0F, 0.2140411F, 0.0F}}}});
  EXPECT_GT(Colored(image, kLowerRight, 255, 0, 0), 40);
  EXPECT_GT(Colored(image, kLowerRight, 0, 128, 0), 40) << "linear 0.214 is half in sRGB";
  EXPECT_GT(Bright(image, kLowerRight), 30) << "the names";
  EXPECT_EQ(Changed(image, kUpperLeft), 0);
}

TEST(Annotation, ALongNameInTheLegendEndsBeforeTheEdge) {
  const frame::RgbImage image =
      Annotated({.legend = {{std::string(300, 'W'), {1.0F, 0.0F, 0.0F}}}});
  EXPECT_GT(Changed(image, {500, 250, 600, kHeight_px}), 100) << "as far as there is room";
  EXPECT_EQ(Changed(image, {kWidth_px - 7, 0, kWidth_px, kHeight_px}), 0) << "a margin";
  EXPECT_GT(Colored(image, kLowerLeft, 255, 0, 0), 40) << "the colour";
}

TEST(Annotation, SmallPicturesKeepTheirSizeAndNothingBreaks) {
  for (const int size_px : {1, 2, 16, 64}) {
    frame::RgbImage image{size_px, size_px,
                          std::vector<std::uint8_t>(std::size_t{3} * size_px * size_px, kGrey)};
    EXPECT_TRUE(Annotate({.title = "A storm",
                          .run = "run",
                          .valid_time = "2013-05-20 20:10Z",
                          .legend = {{"cloud", {}}}},
                         image)
                    .ok());
    EXPECT_EQ(image.rgb.size(), std::size_t{3} * size_px * size_px);
  }
}

TEST(Logo, WhatIsNoPngIsRefusedByName) {
  const auto expect = [](const std::string& bytes, const std::string& text) {
    const auto logo = Logo::Decode(bytes, "--logo mark.png");
    EXPECT_EQ(logo.status().code(), absl::StatusCode::kDataLoss);
    EXPECT_THAT(logo.status().message(), HasSubstr("--logo mark.png"));
    EXPECT_THAT(logo.status().message(), HasSubstr(text));
  };
  const std::string png = LogoPng(64, 64);
  expect("", "not a PNG");
  expect("GIF89a", "not a PNG");
  expect(png.substr(0, png.size() / 2), "damaged");
  // The first chunk after IHDR says that it has 2 GiB.
  std::string longer = png;
  longer.insert(8 + 25, std::string("\x7f\xff\xff\xfftEXt", 8));
  expect(longer, "it is cut short");
  std::string huge = png;
  huge[16] = '\x7f';
  expect(huge, "is 2130706496 x 64 pixels");
}

}  // namespace
}  // namespace thunderhead::product
