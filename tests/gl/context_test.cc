#include "gl/context.h"

#include "gl/objects.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/gl_context.h"

namespace thunderhead::gl {
namespace {

using testing::HasSubstr;

TEST(Context, SoftwareIsAlwaysThere) {
  const auto context = Context::Create("software");
  ASSERT_TRUE(context.ok()) << context.status();
  EXPECT_EQ((*context)->Info().device, "software");
  EXPECT_THAT((*context)->Info().renderer, HasSubstr("llvmpipe"));
}

TEST(Context, CanBeOpenedAgainAfterItsEnd) {
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(Context::Create("software").ok());
}

TEST(Context, AGpuThatIsNotThereIsAnError) {
  const auto context = Context::Create("63");
  ASSERT_FALSE(context.ok());
  EXPECT_EQ(context.status().code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(std::string(context.status().message()), HasSubstr("device 63"));
  EXPECT_THAT(std::string(context.status().message()), HasSubstr("--device software"));
}

TEST(Context, NamesWhatADeviceMayBe) {
  const auto context = Context::Create("fast");
  ASSERT_FALSE(context.ok());
  EXPECT_EQ(context.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(context.status().message()), HasSubstr("'fast'"));
}

TEST(Framebuffer, KeepsWhatItIsClearedTo) {
  const auto context = test_support::OpenContext();
  ASSERT_TRUE(context.ok());
  const Texture2D texture(GL_RGBA32F, {3, 2});
  Framebuffer(texture).Clear(0.25F, 0.5F, 2.0F, 1.0F);
  float texels[24];
  glGetTextureImage(texture.Get(), 0, GL_RGBA, GL_FLOAT, sizeof(texels), texels);
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(texels[4 * i], 0.25F);
    EXPECT_EQ(texels[4 * i + 2], 2.0F);
  }
  EXPECT_EQ(texture.Bytes(), 96U);
}

}  // namespace
}  // namespace thunderhead::gl
