#include "renderers/scene_renderer.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "frame/tone_map.h"
#include "gl/context.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/slab.h"

namespace thunderhead::renderers {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class SceneRendererTest : public testing::Test {
 protected:
  void SetUp() override {
    auto context = gl::Context::Create("software");
    ASSERT_TRUE(context.ok()) << context.status();
    context_ = *std::move(context);
    renderer_ = std::make_unique<SceneRenderer>();
    scene_.output = {48, 32, 90};
    scene_.rendering.slices = 16;
    scene_.camera.target_m = {0.0, 0.0, 1000.0};
    scene_.camera.distance_m = 12e3;
  }
  void TearDown() override {
    renderer_.reset();
    context_.reset();
  }

  std::vector<std::string> StagesOf(const DrawQuality& quality = {}) {
    const auto frame = renderer_->Draw(scene_, fields_, quality);
    EXPECT_TRUE(frame.ok()) << frame.status();
    std::vector<std::string> names;
    for (const StageTime& stage : frame->stages) names.push_back(stage.stage);
    return names;
  }

  std::vector<float> Pixels(SceneRenderer* renderer) {
    const auto frame = renderer->Draw(scene_, fields_, {});
    EXPECT_TRUE(frame.ok()) << frame.status();
    return frame::ReadLinear(*frame->radiance);
  }

  std::unique_ptr<gl::Context> context_;
  std::unique_ptr<SceneRenderer> renderer_;
  std::shared_ptr<const volume::HydrometeorFields> fields_ =
      support::MakeSlab(4000.0, 2000.0, 0.01);
  scene::Scene scene_;
};

TEST_F(SceneRendererTest, AChangeRerunsOnlyWhatItDirties) {
  EXPECT_THAT(StagesOf(), ElementsAre("extinction", "upload", "slices"));
  EXPECT_THAT(StagesOf(), IsEmpty());
  scene_.display.exposure_ev = 1.0;
  EXPECT_THAT(StagesOf(), IsEmpty());
  scene_.camera.azimuth_deg += 5.0;
  EXPECT_THAT(StagesOf(), ElementsAre("slices"));
  scene_.sun.elevation_deg += 5.0;
  EXPECT_THAT(StagesOf(), ElementsAre("slices"));
  scene_.fields[0].scale = 2.0F;
  EXPECT_THAT(StagesOf(), ElementsAre("extinction", "upload", "slices"));
  EXPECT_THAT(StagesOf({0.5, 1.0}), ElementsAre("slices"));
  fields_ = support::MakeSlab(4000.0, 2000.0, 0.02);
  EXPECT_THAT(StagesOf(), ElementsAre("extinction", "upload", "slices"));
}

TEST_F(SceneRendererTest, KeptStagesGiveThePictureThatAFreshRendererGives) {
  const auto change = [&](int step) {
    switch (step) {
      case 0:
        scene_.camera.azimuth_deg = 123.0;
        break;
      case 1:
        scene_.sun.azimuth_deg = 20.0;
        break;
      case 2:
        scene_.rendering.mode = scene::Mode::kUniformPhaseLowAlbedo;
        break;
      case 3:
        scene_.rendering.false_colors = true;
        break;
      case 4:
        scene_.fields[0].scale = 0.1F;
        break;
      case 5:
        scene_.rendering.mode = scene::Mode::kPerFieldPhaseTranslucent;
        break;
      case 6:
        scene_.sky.brightness = 0.2;
        break;
      default:
        scene_.output = {32, 32, 90};
    }
  };
  for (int step = 0; step < 8; ++step) {
    change(step);
    SceneRenderer fresh;
    EXPECT_EQ(Pixels(renderer_.get()), Pixels(&fresh)) << "step " << step;
  }
}

TEST_F(SceneRendererTest, FieldsOutOfSightCostNothing) {
  scene_.fields[0].visible = false;
  const auto frame = renderer_->Draw(scene_, fields_, {});
  ASSERT_TRUE(frame.ok());
  EXPECT_THAT(frame->fields, IsEmpty());
  EXPECT_EQ(frame->slices, 0);
  EXPECT_EQ(frame->occupied_share, 0.0);
}

TEST_F(SceneRendererTest, ACloudIsBrighterThanTheGroundBehindIt) {
  const std::vector<float> with = Pixels(renderer_.get());
  scene_.fields[0].visible = false;
  const std::vector<float> without = Pixels(renderer_.get());
  const std::size_t middle = 4 * (16 * 48 + 24);
  EXPECT_GT(with[middle], 2.0F * without[middle]);
  // The sky in the top corner is the same.
  EXPECT_EQ(with[4 * (31 * 48)], without[4 * (31 * 48)]);
}

TEST_F(SceneRendererTest, NightIsDarkAndFinite) {
  scene_.sun.elevation_deg = -30.0;
  for (const float value : Pixels(renderer_.get())) {
    ASSERT_TRUE(std::isfinite(value));
    ASSERT_GE(value, 0.0F);
  }
}

TEST_F(SceneRendererTest, ACameraInsideTheCloudSeesCloudEverywhere) {
  scene_.camera.distance_m = 10.0;
  scene_.fields[0].scale = 100.0F;
  const std::vector<float> pixels = Pixels(renderer_.get());
  for (std::size_t i = 0; i < pixels.size(); i += 4) ASSERT_TRUE(std::isfinite(pixels[i]));
}

TEST(ToneMap, MapsKnownRadiances) {
  const auto context = gl::Context::Create("software");
  ASSERT_TRUE(context.ok());
  const gl::Texture2D linear(GL_RGBA32F, {2, 1});
  gl::Framebuffer(linear).Clear(0.0F, 0.5F / frame::kExposureAtZeroEv, 1e6F, 1.0F);
  frame::ToneMapper mapper;
  scene::Display display;
  display.tone_map = scene::ToneMap::kLinear;
  const auto mapped = mapper.Map(linear, display);
  ASSERT_TRUE(mapped.ok());
  EXPECT_NEAR(mapped->rgb[0], 0, 1);
  EXPECT_NEAR(mapped->rgb[1], 188, 1);  // sRGB of one half
  EXPECT_NEAR(mapped->rgb[2], 255, 1);
  display.exposure_ev = 1.0;
  EXPECT_NEAR(mapper.Map(linear, display)->rgb[1], 255, 1);
  display.tone_map = scene::ToneMap::kFilmic;
  // 1 - exp(-1) = 0.632, in sRGB 208.
  EXPECT_NEAR(mapper.Map(linear, display)->rgb[1], 208, 1);
}

}  // namespace
}  // namespace thunderhead::renderers
