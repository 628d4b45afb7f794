// A domain of 1000 km by 960 km with 30 storms: as a regional model has it.
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
#include "tests/support/wide_domain.h"
#include "volume/storm_store.h"
#include "volume/visible_box.h"

namespace thunderhead {
namespace {

class WideDomainTest : public testing::Test {
 protected:
  void SetUp() override {
    auto context = gl::Context::Create("software");
    ASSERT_TRUE(context.ok()) << context.status();
    context_ = *std::move(context);
    auto store = volume::StormStore::Open({THUNDERHEAD_SOURCE_DIR "/samples/supercell.nc"}, {});
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

  // Looks from `elevation_deg`, or from that of the default.
  scene::Scene SceneFrom(std::optional<double> elevation_deg, glm::ivec2 size_px) const {
    scene::Scene scene;
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

// Storms far away stand in the light of a thousand kilometres of air.
TEST_F(WideDomainTest, StormsAreBrightAsFarAsTheHorizon) {
  for (const double elevation_deg : {4.0, 35.0}) {
    const picture::LinearPicture picture = Draw(SceneFrom(elevation_deg, {640, 360}));
    int storm = 0;
    int dark = 0;
    for (std::size_t i = 0; i < picture.radiance.size(); ++i) {
      if (picture.opacity[i] < 0.9F) continue;
      ++storm;
      // Nor not a number.
      if (!(frame::LuminanceOf(picture.radiance[i]) >= 0.02F)) ++dark;
    }
    EXPECT_GT(storm, 500);
    EXPECT_LE(dark, storm / 100) << elevation_deg;
  }
}

}  // namespace
}  // namespace thunderhead
