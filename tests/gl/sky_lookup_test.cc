// Tests of the sky as the GPU looks it up, pixel by pixel, compared with the same table on the CPU.
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "frame/tone_map.h"
#include "gl/context.h"
#include "glm/geometric.hpp"
#include "gtest/gtest.h"
#include "physics/sky.h"
#include "renderers/scene_renderer.h"
#include "scene/view.h"
#include "tests/support/gl_context.h"
#include "tests/support/slab.h"
#include "tests/support/techniques.h"

namespace thunderhead::renderers {
namespace {

constexpr int kWidth_px = 180;
constexpr int kHeight_px = 120;

class SkyLookup : public testing::Test {
 protected:
  void SetUp() override {
    auto context = test_support::OpenContext();
    ASSERT_TRUE(context.ok()) << context.status();
    context_ = *std::move(context);
    renderer_ = std::make_unique<SceneRenderer>();
    for (scene::FieldParameters& field : scene_.fields) field.visible = false;
    // The ground is black, so below the horizon only the air in front of it is visible.
    scene_.sky = {.brightness = 1.0, .ground_albedo = 0.0, .turbidity = 1.5};
    scene_.output = {kWidth_px, kHeight_px, 90};
  }
  void TearDown() override {
    renderer_.reset();
    context_.reset();
  }

  // Looks from above the middle of the world, where the vertical is the z axis. The view is 112
  // degrees wide and 90 high.
  void LookTo(double eye_m, double azimuth_deg, double elevation_deg) {
    scene_.camera = scene::SpotterCamera{.place_m = {0.0, 0.0},
                                         .eye_height_m = eye_m,
                                         .azimuth_deg = azimuth_deg,
                                         .elevation_deg = elevation_deg,
                                         .focal_length_mm = 12.0};
  }

  // Returns, for each pixel and colour, the ratio of the GPU's value to the CPU's. It is 0 next to
  // the horizon, which is an edge.
  std::vector<glm::dvec3> GpuOverCpu() {
    const auto frame =
        renderer_->Draw(scene_, fields_, {.single_precision = true, .sun_seen = false});
    EXPECT_TRUE(frame.ok()) << frame.status();
    const std::vector<float> pixels = frame::ReadLinear(*frame->radiance);
    const scene::View view = scene::ViewOf(scene_, *fields_);
    const physics::Atmosphere atmosphere(static_cast<float>(scene_.sky.turbidity), 0.0F);
    const auto eye_m = static_cast<float>(view.altitude_m);
    const physics::ClearSky sky(
        atmosphere, glm::vec3(scene::Direction(scene_.sun.azimuth_deg, scene_.sun.elevation_deg)),
        {.eye_m = eye_m});
    std::vector<glm::dvec3> quotients;
    for (int y = 0; y < kHeight_px; ++y) {
      for (int x = 0; x < kWidth_px; ++x) {
        const double right = ((x + 0.5) / kWidth_px * 2.0 - 1.0) * view.tan_half_width;
        const double up = ((y + 0.5) / kHeight_px * 2.0 - 1.0) * view.tan_half_height;
        const glm::dvec3 ray = glm::normalize(view.local_from_world *
                                              (view.forward + right * view.right + up * view.up));
        const glm::vec3 expected = sky.At(glm::vec3(ray)).radiance;
        const auto at = static_cast<std::size_t>(4 * (y * kWidth_px + x));
        const bool edge = std::abs(ray.z - physics::HorizonSine(eye_m)) < 0.02;
        for (int color = 0; color < 3 && !edge; ++color) {
          EXPECT_TRUE(std::isfinite(pixels[at]) && expected[color] > 0.0F) << x << ' ' << y;
        }
        quotients.push_back(edge ? glm::dvec3(0.0)
                                 : glm::dvec3(pixels[at], pixels[at + 1], pixels[at + 2]) /
                                       glm::dvec3(expected));
      }
    }
    return quotients;
  }

  std::unique_ptr<gl::Context> context_;
  std::unique_ptr<SceneRenderer> renderer_;
  std::shared_ptr<const volume::HydrometeorFields> fields_ =
      support::MakeSlab(4000.0, 2000.0, 0.01);
  scene::Scene scene_ = test_support::PlainScene();
};

struct Worst {
  double off = 0.0;   // largest difference from the CPU's value
  double jump = 0.0;  // largest change of that difference between neighbouring pixels
  int compared = 0;
};

Worst WorstOf(const std::vector<glm::dvec3>& quotients) {
  Worst worst;
  for (int y = 0; y < kHeight_px; ++y) {
    for (int x = 0; x < kWidth_px; ++x) {
      const auto at = static_cast<std::size_t>(y * kWidth_px + x);
      for (int color = 0; color < 3; ++color) {
        const double here = quotients[at][color];
        if (here == 0.0) continue;
        ++worst.compared;
        worst.off = std::max(worst.off, std::abs(here - 1.0));
        const double beside = x + 1 < kWidth_px ? quotients[at + 1][color] : 0.0;
        const double above = y + 1 < kHeight_px ? quotients[at + kWidth_px][color] : 0.0;
        for (const double other : {beside, above}) {
          if (other != 0.0) worst.jump = std::max(worst.jump, std::abs(other - here));
        }
      }
    }
  }
  return worst;
}

class SkyLookupFrom : public SkyLookup,
                      public testing::WithParamInterface<std::pair<double, bool>> {};

TEST_P(SkyLookupFrom, IsWhatTheCpuFindsWithoutSeams) {
  const auto& [eye_m, mixed] = GetParam();
  for (const double sun_deg : {-4.0, 5.0, 50.0}) {
    scene_.sun.elevation_deg = sun_deg;
    for (const double turn_deg : {0.0, 90.0, 180.0, 270.0}) {
      LookTo(eye_m, scene_.sun.azimuth_deg + turn_deg, eye_m < 10.0 ? 46.0 : 10.0);
      const Worst worst = WorstOf(GpuOverCpu());
      EXPECT_GT(worst.compared, kWidth_px * kHeight_px);
      // The error is larger where two tables are mixed: tables of two heights have their horizons,
      // and the twilight above them, in different places.
      EXPECT_LT(worst.off, mixed ? 0.03 : 1e-3) << "sun " << sun_deg << ", turned " << turn_deg;
      EXPECT_LT(worst.jump, mixed ? 0.01 : 1e-3) << "sun " << sun_deg << ", turned " << turn_deg;
    }
  }
}

// The heights include those with a table (2500 m (exp(k / 16) - 1)) and others, for which two
// tables are mixed.
INSTANTIATE_TEST_SUITE_P(Heights, SkyLookupFrom,
                         testing::Values(std::pair(710.0635, false), std::pair(11886.5067, false),
                                         std::pair(2.0, true), std::pair(600.0, true),
                                         std::pair(12000.0, true)));

}  // namespace
}  // namespace thunderhead::renderers
