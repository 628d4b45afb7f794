// A domain of 1000 km by 960 km with 30 storms: as a regional model has it.
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "frame/tone_map.h"
#include "frame/white_balance.h"
#include "gl/context.h"
#include "gtest/gtest.h"
#include "reference/scene_problem.h"
#include "reference/trace_rays.h"
#include "renderers/scene_renderer.h"
#include "scene/view.h"
#include "tests/support/gl_context.h"
#include "tests/support/wide_domain.h"
#include "volume/storm_store.h"
#include "volume/visible_box.h"

namespace thunderhead {
namespace {

class WideDomainTest : public testing::Test {
 protected:
  void SetUp() override {
    auto context = test_support::OpenContext();
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

  // The mean luminance in the reference of the pixels whose indices are given.
  double Traced(const scene::Scene& scene, const std::vector<int>& pixels) const {
    const auto medium =
        reference::MediumOf(scene, *fields_, reference::MediumOptions{.peak_cut_deg = 20.0});
    EXPECT_TRUE(medium.ok()) << medium.status();
    const reference::Surroundings surroundings =
        reference::SurroundingsOf(scene, *fields_, reference::GroundLight::kShaded);
    const reference::Camera camera = reference::CameraOf(scene, *fields_);
    const glm::dvec2 size_px(scene.output.width_px, scene.output.height_px);
    std::vector<reference::Ray> rays;
    for (const int pixel : pixels) {
      const glm::dvec2 at_px(pixel % scene.output.width_px, pixel / scene.output.width_px);
      const glm::dvec2 at = 2.0 * (at_px + 0.5) / size_px - 1.0;
      rays.push_back(camera.RayThrough(at.x, -at.y));
    }
    double sum = 0.0;
    for (const glm::dvec3& radiance :
         reference::TraceRays(**medium, surroundings, rays, {7, 300, 0})) {
      sum += frame::LuminanceOf(glm::vec3(radiance));
    }
    return sum / static_cast<double>(rays.size());
  }

  std::unique_ptr<gl::Context> context_;
  std::shared_ptr<const volume::HydrometeorFields> fields_;
  std::unique_ptr<renderers::SceneRenderer> renderer_;
};

// Storms far away stand in the light of a thousand kilometres of air. Near ones have bases in their
// own shadow, which are as dark in the reference: what is darker than a hundredth of all must be so
// there too. The 300 paths of each of some 60 pixels are good for 5 %, and their rays pass model
// cells, while the picture has detail.
TEST_F(WideDomainTest, StormsAreBrightAsFarAsTheHorizon) {
  for (const double elevation_deg : {4.0, 35.0}) {
    const scene::Scene scene = SceneFrom(elevation_deg, {640, 360});
    const picture::LinearPicture picture = Draw(scene);
    int storm = 0;
    std::vector<int> dark;
    double drawn = 0.0;
    for (std::size_t i = 0; i < picture.radiance.size(); ++i) {
      if (picture.opacity[i] < 0.9F) continue;
      ++storm;
      // Nor not a number.
      const float luminance = frame::LuminanceOf(picture.radiance[i]);
      if (luminance >= 0.02F) continue;
      dark.push_back(static_cast<int>(i));
      drawn += luminance;
    }
    EXPECT_GT(storm, 500);
    EXPECT_LE(static_cast<int>(dark.size()), storm / 50) << elevation_deg;
    if (static_cast<int>(dark.size()) <= storm / 100) continue;
    EXPECT_GT(drawn / static_cast<double>(dark.size()), 0.8 * Traced(scene, dark)) << elevation_deg;
  }
}

TEST_F(WideDomainTest, OneRayAPixelIsNearlyAsGoodAs64) {
  constexpr int kRays = 8;  // along each side of a pixel
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
    shown.display.exposure_ev = mapped->exposure_ev;  // the first's counts for both
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
  // Storms cover little of the picture.
  EXPECT_LE(std::sqrt(storm_squares / storm_values), 0.1);
}

}  // namespace
}  // namespace thunderhead
