#include "renderers/scene_renderer.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "frame/tone_map.h"
#include "gl/context.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "scene/view.h"
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
    Orbit().target_m = {0.0, 0.0, 1000.0};
    Orbit().distance_m = 12e3;
  }
  void TearDown() override {
    renderer_.reset();
    context_.reset();
  }

  scene::OrbitCamera& Orbit() { return std::get<scene::OrbitCamera>(scene_.camera); }

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
  scene_.rendering.renderer = scene::Renderer::kHalfAngle;
  EXPECT_THAT(StagesOf(), ElementsAre("extinction", "upload", "slices", "composite"));
  EXPECT_THAT(StagesOf(), IsEmpty());
  scene_.display.exposure_ev = 1.0;
  EXPECT_THAT(StagesOf(), IsEmpty());
  Orbit().azimuth_deg += 5.0;
  EXPECT_THAT(StagesOf(), ElementsAre("slices", "composite"));
  scene_.sun.elevation_deg += 5.0;
  EXPECT_THAT(StagesOf(), ElementsAre("slices", "composite"));
  scene_.fields[0].scale = 2.0F;
  EXPECT_THAT(StagesOf(), ElementsAre("extinction", "upload", "slices", "composite"));
  EXPECT_THAT(StagesOf({0.5, 1.0}), ElementsAre("slices", "composite"));
  fields_ = support::MakeSlab(4000.0, 2000.0, 0.02);
  EXPECT_THAT(StagesOf(), ElementsAre("extinction", "upload", "slices", "composite"));
}

TEST_F(SceneRendererTest, TheLightVolumeIsKeptWhileOnlyTheCameraMoves) {
  scene_.rendering.renderer = scene::Renderer::kLightVolume;
  EXPECT_THAT(StagesOf(), ElementsAre("extinction", "upload", "light", "view", "composite"));
  Orbit().azimuth_deg += 5.0;
  EXPECT_THAT(StagesOf(), ElementsAre("view", "composite"));
  scene_.sun.elevation_deg += 5.0;
  EXPECT_THAT(StagesOf(), ElementsAre("light", "view", "composite"));
  scene_.rendering.renderer = scene::Renderer::kHalfAngle;
  EXPECT_THAT(StagesOf(), ElementsAre("slices", "composite"));
  scene_.rendering.renderer = scene::Renderer::kLightVolume;
  EXPECT_THAT(StagesOf(), ElementsAre("light", "view", "composite"));
}

TEST_F(SceneRendererTest, KeptStagesGiveThePictureThatAFreshRendererGives) {
  const auto change = [&](int step) {
    switch (step) {
      case 0:
        Orbit().azimuth_deg = 123.0;
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

TEST_F(SceneRendererTest, FromAboveACloudStandsWhereItsCoordinatesSay) {
  // 4 km of cloud in the left half of 16 km: its middle is 4 km west of the picture's.
  scene_.camera = scene::TopDownCamera{{4000.0, 0.0}, 16e3};
  const std::vector<float> with = Pixels(renderer_.get());
  scene_.fields[0].visible = false;
  const std::vector<float> without = Pixels(renderer_.get());
  for (std::size_t y = 0; y < 32; ++y) {
    for (std::size_t x = 0; x < 48; ++x) {
      const double east_m = 4000.0 + 16e3 * ((static_cast<double>(x) + 0.5) / 48 - 0.5);
      const double north_m = 16e3 * (32.0 / 48.0) * ((static_cast<double>(y) + 0.5) / 32 - 0.5);
      const double outside_m = std::max(std::abs(east_m), std::abs(north_m)) - 2000.0;
      const std::size_t at = 4 * (48 * y + x);
      if (outside_m > 0.0) {
        ASSERT_EQ(with[at], without[at]) << east_m << ' ' << north_m;
      } else if (outside_m < -400.0) {
        ASSERT_GT(with[at], 1.5F * without[at]) << east_m << ' ' << north_m;
      }
    }
  }
}

TEST_F(SceneRendererTest, ASpottersHorizonDips) {
  scene::SpotterCamera camera;
  camera.place_m = {0.0, -60e3};
  camera.eye_height_m = 12000.0;  // the dip is sqrt(2 h / R): 3.25 degrees
  camera.azimuth_deg = 180.0;     // away from the storm
  camera.elevation_deg = 0.0;
  camera.focal_length_mm = 50.0;
  scene_.camera = camera;
  scene_.sky.ground_albedo = 0.0;
  scene_.output = {8, 400, 90};
  const std::vector<float> pixels = Pixels(renderer_.get());
  // Just below the horizon the ground is so far that it looks like the sky there; count from where
  // the radiance, mirrored about level, stops being the same.
  const double dip = std::sqrt(2.0 * 12000.0 / scene::kEffectiveEarthRadius_m);
  const auto row_of = [](double tangent) { return 200.0 * (1.0 + tangent * 50.0 / 12.0); };
  const auto differs = [&](int below) {
    const auto low = static_cast<std::size_t>(4 * 8 * (199 - below));
    const auto high = static_cast<std::size_t>(4 * 8 * (200 + below));
    return std::abs(pixels[low] - pixels[high]) > 1e-3F * pixels[high];
  };
  const int dip_rows = static_cast<int>(row_of(dip) - 200.0);
  for (int below = 0; below < dip_rows - 1; ++below) ASSERT_FALSE(differs(below)) << below;
  EXPECT_TRUE(differs(dip_rows + 2));
}

TEST_F(SceneRendererTest, NightIsDarkAndFinite) {
  scene_.sun.elevation_deg = -30.0;
  for (const float value : Pixels(renderer_.get())) {
    ASSERT_TRUE(std::isfinite(value));
    ASSERT_GE(value, 0.0F);
  }
}

TEST_F(SceneRendererTest, ACameraInsideTheCloudSeesCloudEverywhere) {
  Orbit().distance_m = 10.0;
  scene_.fields[0].scale = 100.0F;
  const std::vector<float> pixels = Pixels(renderer_.get());
  for (std::size_t i = 0; i < pixels.size(); i += 4) ASSERT_TRUE(std::isfinite(pixels[i]));
}

TEST_F(SceneRendererTest, MoreBricksThanOneRowOfWorkGroupsHolds) {
  // 48 x 48 x 48 bricks of two cells a side, against a coarse grid of the same cloud.
  const auto brightness = [&](const glm::ivec3& cells) {
    fields_ = support::MakeSlab(4000.0, 2000.0, 0.01, cells);
    const std::vector<float> pixels = Pixels(renderer_.get());
    return pixels[4 * (16 * 48 + 24)];
  };
  const float fine = brightness({96, 96, 96});
  EXPECT_NEAR(fine / brightness({32, 32, 32}), 1.0F, 0.1F);
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
