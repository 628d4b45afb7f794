// Tests of a domain of 1000 km by 960 km with 30 storms, as in a regional model.
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "frame/tone_map.h"
#include "frame/white_balance.h"
#include "gl/context.h"
#include "gtest/gtest.h"
#include "renderers/scene_renderer.h"
#include "scene/view.h"
#include "storm_store/storm_store.h"
#include "tests/support/gl_context.h"
#include "tests/support/wide_domain.h"
#include "volume/visible_box.h"

namespace thunderhead {
namespace {

class WideDomainTest : public testing::Test {
 protected:
  void SetUp() override {
    auto context = test_support::OpenContext();
    ASSERT_TRUE(context.ok()) << context.status();
    context_ = *std::move(context);
    auto store =
        storm_store::StormStore::Open({THUNDERHEAD_SOURCE_DIR "/samples/supercell.nc"}, {});
    ASSERT_TRUE(store.ok()) << store.status();
    const auto storm = (*store)->Get((*store)->Storms().front()->id, 2, {});
    ASSERT_TRUE(storm.ok()) << storm.status();
    fields_ = support::WideDomain(**storm, 5, 6, 2);
    renderer_ = std::make_unique<renderers::SceneRenderer>();
  }
  void TearDown() override {
    renderer_.reset();
    fields_.reset();
    context_.reset();
  }

  // Returns a scene that looks from `elevation_deg`, or from the default elevation.
  scene::Scene SceneFrom(std::optional<double> elevation_deg, glm::ivec2 size_px) const {
    scene::Scene scene;
    scene.sun = {255.0, 35.0};
    scene.output = {size_px.x, size_px.y, 90};
    const volume::WorldBox box = volume::VisibleBox(*fields_, physics::SizeSource::kModel);
    scene::OrbitCamera camera;
    camera.elevation_deg =
        elevation_deg.value_or(scene::FramingElevation_deg(box.low_m, box.high_m));
    scene.camera =
        scene::Framing(camera, box.low_m, box.high_m, static_cast<double>(size_px.x) / size_px.y);
    return scene;
  }

  picture::LinearPicture Draw(const scene::Scene& scene) {
    const auto frame = renderer_->Draw(scene, fields_, {});
    EXPECT_TRUE(frame.ok()) << frame.status();
    return frame::PictureOf(*frame->radiance);
  }

  std::unique_ptr<gl::Context> context_;
  std::shared_ptr<const volume::HydrometeorFields> fields_;
  std::unique_ptr<renderers::SceneRenderer> renderer_;
};

// Far storms are lit through up to a thousand kilometres of air.
TEST_F(WideDomainTest, StormsAreBrightAsFarAsTheHorizon) {
  for (const double elevation_deg : {4.0, 35.0}) {
    const picture::LinearPicture picture = Draw(SceneFrom(elevation_deg, {640, 360}));
    int storm = 0;
    int dark = 0;
    for (std::size_t i = 0; i < picture.radiance.size(); ++i) {
      if (picture.opacity[i] < 0.9F) continue;
      ++storm;
      // The negated comparison also counts values that are not a number.
      if (!(frame::LuminanceOf(picture.radiance[i]) >= 0.02F)) ++dark;
    }
    EXPECT_GT(storm, 500);
    EXPECT_LE(dark, storm / 100) << elevation_deg;
  }
}

TEST_F(WideDomainTest, OneRayAPixelIsNearlyAsGoodAs64) {
  constexpr int kRays = 8;  // number of rays along each side of a pixel
  const glm::ivec2 size_px(320, 180);
  const scene::Scene scene = SceneFrom(std::nullopt, size_px);
  const picture::LinearPicture one = Draw(scene);
  scene::Scene finer = scene;
  finer.output.width_px *= kRays;
  finer.output.height_px *= kRays;
  const picture::LinearPicture many = Draw(finer);
  picture::LinearPicture mean;
  mean.size_px = size_px;
  mean.radiance.assign(one.radiance.size(), glm::vec3(0.0F));
  mean.opacity.assign(one.radiance.size(), 0.0F);
  for (int y = 0; y < size_px.y * kRays; ++y) {
    for (int x = 0; x < size_px.x * kRays; ++x) {
      const int from = y * size_px.x * kRays + x;
      const int to = y / kRays * size_px.x + x / kRays;
      mean.radiance[to] += many.radiance[from] / static_cast<float>(kRays * kRays);
      mean.opacity[to] += many.opacity[from] / static_cast<float>(kRays * kRays);
    }
  }
  frame::ToneMapper tone_mapper;
  scene::Scene shown = scene;
  const auto displayed = [&](const picture::LinearPicture& picture) {
    const auto mapped = tone_mapper.Map(frame::TextureOf(picture), shown);
    EXPECT_TRUE(mapped.ok()) << mapped.status();
    shown.display.exposure_ev = mapped->exposure_ev;  // the same exposure for both pictures
    return mapped->rgb;
  };
  const std::vector<std::uint8_t> expected = displayed(mean);
  const std::vector<std::uint8_t> drawn = displayed(one);
  double squares = 0.0;
  double storm_squares = 0.0;
  double storm_values = 0.0;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    const double square = std::pow((drawn[i] - expected[i]) / 255.0, 2);
    squares += square;
    storm_squares += mean.opacity[i / 3] * square;
    storm_values += mean.opacity[i / 3];
  }
  EXPECT_LE(std::sqrt(squares / static_cast<double>(drawn.size())), 0.02);
  // Only the pixels with storms are compared, because storms cover a small part of the picture.
  EXPECT_LE(std::sqrt(storm_squares / storm_values), 0.1);
}

}  // namespace
}  // namespace thunderhead
