#include "gl/computed_target.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::gl {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(ComputedTarget, StoresEachOutputInTheImageOfItsLocation) {
  const std::string text = AsComputedPixel(
      "layout(location = 0) out vec4 radiance;  // of the storm\n"
      "layout(location = 1) out float distance_m;\n"
      "void main() { radiance = vec4(1.0); distance_m = 2.0; }\n");
  EXPECT_THAT(text, HasSubstr("\nvec4 radiance;\nfloat distance_m;\nvoid draw_pixel() {"));
  EXPECT_THAT(text, HasSubstr("layout(binding = kTargetImages + 0) writeonly uniform image2D "
                              "image_of_radiance;\n"));
  EXPECT_THAT(text, HasSubstr("layout(binding = kTargetImages + 1) writeonly uniform image2D "
                              "image_of_distance_m;\n"));
  EXPECT_THAT(text, HasSubstr("imageStore(image_of_radiance, pixel, radiance);"));
  EXPECT_THAT(
      text, HasSubstr("imageStore(image_of_distance_m, pixel, vec4(distance_m, 0.0, 0.0, 0.0));"));
}

TEST(ComputedTarget, AnOutputWithoutLocationIsTheFirst) {
  EXPECT_THAT(AsComputedPixel("out vec4 display;\nvoid main() {}\n"),
              HasSubstr("layout(binding = kTargetImages + 0) writeonly uniform image2D "
                        "image_of_display;\n"));
}

TEST(ComputedTarget, ThePlaceIsAVariable) {
  const std::string text = AsComputedPixel(
      "in vec2 position;\nout vec4 color;\nvoid main() { color = gl_FragCoord + position.x; }\n");
  EXPECT_THAT(text, HasSubstr("vec2 position;\nvec4 pixel_centre;\n"));
  EXPECT_THAT(text, HasSubstr("color = pixel_centre + position.x;"));
  EXPECT_THAT(text, Not(HasSubstr("in vec2 position")));
  EXPECT_THAT(text, Not(HasSubstr("gl_FragCoord")));
}

// The number of lines must not change, so that a compiler's message names the correct line.
TEST(ComputedTarget, KeepsTheCountOfLines) {
  const std::string text = AsComputedPixel("in vec2 position;\nout vec4 color;\nfloat third;\n");
  EXPECT_THAT(text, HasSubstr("pixel_centre;\n\nvec4 color;\nfloat third;\n"));
}

}  // namespace
}  // namespace thunderhead::gl
