// Tests of sunlight at different heights after sunset, on a tall thin cloud. It is compared with
// the closed form of the height of the Earth's shadow, and with the reference. The sky is black, so
// all light comes from the sun.
#include <algorithm>
#include <cmath>
#include <memory>
#include <ostream>
#include <vector>

#include "frame/tone_map.h"
#include "gl/context.h"
#include "glm/trigonometric.hpp"
#include "gtest/gtest.h"
#include "physics/atmosphere.h"
#include "reference/scene_problem.h"
#include "reference/trace_rays.h"
#include "renderers/scene_renderer.h"
#include "shaders/bindings.h"
#include "tests/support/gl_context.h"
#include "tests/support/slab.h"
#include "tests/support/techniques.h"

namespace thunderhead::renderers {
namespace {

constexpr double kTwilightEye_m = 20e3;
constexpr double kDepression_deg = 2.0;

// Returns the height below which no part of the sun's disc is above the horizon. A ray that grazes
// a sphere of radius R at a depression d passes R (1 / cos d - 1) above the ground where it has
// that elevation.
double ShadowHeight_m(double depression_deg) {
  return physics::kEffectiveEarthRadius_m * (1.0 / std::cos(glm::radians(depression_deg)) - 1.0);
}

class TwilightTest : public testing::TestWithParam<accuracy::PlainTechnique> {
 protected:
  static constexpr int kWidth_px = 8;
  static constexpr int kHeight_px = 80;

  void SetUp() override {
    auto context = test_support::OpenContext();
    ASSERT_TRUE(context.ok()) << context.status();
    context_ = *std::move(context);
    renderer_ = std::make_unique<SceneRenderer>();
    test_support::SetTechnique(&scene_.rendering.technique, GetParam());
    scene_.output = {kWidth_px, kHeight_px, 90};
    scene_.sun = {270.0, -kDepression_deg, 1.0};
    scene_.sky.brightness = 0.0;
    scene_.camera = scene::OrbitCamera{{0.0, 0.0, 9e3}, 180.0, 0.0, 100e3, 10.0};
  }
  void TearDown() override {
    renderer_.reset();
    context_.reset();
  }

  double RowHeight_m(int row) const {
    const auto view = scene::ViewOf(scene_, *fields_);
    const double y = 1.0 - 2.0 * (row + 0.5) / kHeight_px;
    return view.eye_m.z + 100e3 * (view.forward.z + y * view.tan_half_height);
  }

  // Returns the middle column, with rows from the top.
  std::vector<glm::vec3> Drawn() {
    DrawQuality quality;
    quality.single_precision = true;
    const auto frame = renderer_->Draw(scene_, fields_, quality);
    EXPECT_TRUE(frame.ok()) << frame.status();
    const picture::LinearPicture picture = frame::PictureOf(*frame->radiance);
    std::vector<glm::vec3> column;
    for (int row = 0; row < kHeight_px; ++row) {
      column.push_back(picture.radiance[static_cast<std::size_t>(kWidth_px * row + kWidth_px / 2)]);
    }
    return column;
  }

  std::vector<glm::dvec3> Traced(const std::vector<int>& rows) const {
    const auto medium =
        reference::MediumOf(scene_, *fields_, reference::MediumOptions{.peak_cut_deg = 20.0});
    EXPECT_TRUE(medium.ok());
    const reference::Camera camera = reference::CameraOf(scene_, *fields_);
    constexpr int kColumn = kWidth_px / 2;
    std::vector<reference::Ray> rays;
    for (const int row : rows) {
      rays.push_back(camera.RayThrough((kColumn + 0.5) / kWidth_px * 2.0 - 1.0,
                                       1.0 - 2.0 * (row + 0.5) / kHeight_px));
    }
    return *reference::TraceRays(
        **medium, reference::SurroundingsOf(scene_, *fields_, reference::GroundLight::kShaded),
        rays, {7, 1'000'000, 0});
  }

  std::unique_ptr<gl::Context> context_;
  std::unique_ptr<SceneRenderer> renderer_;
  // The cloud is so thin, 0.02 from side to side, that light is scattered at most once.
  std::shared_ptr<const volume::HydrometeorFields> fields_ =
      support::MakeSlab(10e3, kTwilightEye_m, 0.02 / 10e3);
  scene::Scene scene_ = test_support::PlainScene();
};

TEST_P(TwilightTest, TheEarthsShadowEndsWhereTheSunRises) {
  const std::vector<glm::vec3> column = Drawn();
  // The height of the shadow follows from the upper edge of the sun's disc. The sunlight table is
  // linear over a step of heights, so one step is subtracted.
  const double dark_m = ShadowHeight_m(kDepression_deg - glm::degrees(physics::kSunRadius_rad)) -
                        static_cast<double>(shaders::kSunlightStep_m);
  const double brightest =
      std::max_element(column.begin(), column.end(), [](auto& a, auto& b) { return a.r < b.r; })->r;
  ASSERT_GT(brightest, 0.0);
  int dark = 0;
  for (int row = 0; row < kHeight_px; ++row) {
    const double height_m = RowHeight_m(row);
    if (height_m < dark_m - 100.0 && height_m > 500.0) {
      EXPECT_EQ(column[static_cast<std::size_t>(row)].r, 0.0F) << height_m;
      ++dark;
    }
    // If the whole disc has risen at that height, red light has come through the air.
    if (height_m > 2.0 * ShadowHeight_m(kDepression_deg) && height_m < kTwilightEye_m - 2e3) {
      EXPECT_GT(column[static_cast<std::size_t>(row)].r, 0.1 * brightest) << height_m;
    }
  }
  EXPECT_GE(dark, 5);
}

TEST_P(TwilightTest, LightIsThatOfTheReference) {
  const std::vector<glm::vec3> column = Drawn();
  const std::vector<int> rows = {12, 24, 36};  // 15 to 10 km high
  const std::vector<glm::dvec3> traced = Traced(rows);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const glm::vec3 drawn = column[static_cast<std::size_t>(rows[i])];
    // The tolerance is for the reference's noise, and for a table that is linear over steps of
    // height.
    for (int color = 0; color < 3; ++color) {
      EXPECT_NEAR(static_cast<double>(drawn[color]), traced[i][color], 0.05 * traced[i][color])
          << RowHeight_m(rows[i]) << ' ' << color;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Techniques, TwilightTest,
                         testing::Values(test_support::kLightVolume, test_support::kHalfAngle),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace thunderhead::renderers
