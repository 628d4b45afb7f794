// Tests of a storm's base, lit from below by ground that the storm shades, compared with the
// reference.
#include <memory>
#include <vector>

#include "frame/tone_map.h"
#include "gl/context.h"
#include "gtest/gtest.h"
#include "reference/path_tracer.h"
#include "reference/scene_problem.h"
#include "reference/trace_rays.h"
#include "renderers/scene_renderer.h"
#include "tests/support/gl_context.h"
#include "tests/support/slab.h"
#include "tests/support/techniques.h"

namespace thunderhead::renderers {
namespace {

// Returns a layer of cloud 30 km wide, 1 to 3 km above the ground, 40 optical depths thick.
std::shared_ptr<const volume::HydrometeorFields> MakeOvercast() {
  const auto slab = support::MakeSlab(30e3, 4e3, 0.02, {32, 32, 16});
  auto overcast = std::make_shared<volume::HydrometeorFields>(*slab);
  std::vector<float>& concentration = overcast->fields[0].concentration_kg_per_m3;
  for (std::size_t i = 0; i < concentration.size(); ++i) {
    const std::size_t layer = i / (32 * 32);
    if (layer < 4 || layer >= 12) concentration[i] = 0.0F;
  }
  overcast->condensate = {{0, 0, 4}, {32, 32, 12}};
  return overcast;
}

class GroundLightTest : public testing::Test {
 protected:
  static constexpr int kSide_px = 24;

  void SetUp() override {
    auto context = test_support::OpenContext();
    ASSERT_TRUE(context.ok()) << context.status();
    context_ = *std::move(context);
    renderer_ = std::make_unique<SceneRenderer>();
    scene_.output = {kSide_px, kSide_px, 90};
    scene_.sun = {0.0, 50.0, 1.0};
    // The camera looks upwards from below the middle.
    scene_.camera = scene::SpotterCamera{{0.0, 0.0}, 1.7, 0.0, 70.0, 100.0};
    test_support::SetTransport(&scene_.rendering.technique, scene::Transport::kDiffusion);
  }
  void TearDown() override {
    renderer_.reset();
    context_.reset();
  }

  // Returns the picture's mean.
  glm::dvec3 Drawn(double albedo) {
    scene_.sky.ground_albedo = albedo;
    const auto frame = renderer_->Draw(scene_, fields_, {});
    EXPECT_TRUE(frame.ok()) << frame.status();
    glm::dvec3 sum(0.0);
    for (const glm::vec3& radiance : frame::PictureOf(*frame->radiance).radiance) sum += radiance;
    return sum / static_cast<double>(kSide_px * kSide_px);
  }

  glm::dvec3 Traced(double albedo) {
    scene_.sky.ground_albedo = albedo;
    const auto medium =
        reference::MediumOf(scene_, *fields_, reference::MediumOptions{.peak_cut_deg = 20.0});
    EXPECT_TRUE(medium.ok());
    const reference::Surroundings surroundings =
        reference::SurroundingsOf(scene_, *fields_, reference::GroundLight::kShaded);
    const reference::Camera camera = reference::CameraOf(scene_, *fields_);
    std::vector<reference::Ray> rays;
    for (const double y : {-0.75, -0.25, 0.25, 0.75}) {
      for (const double x : {-0.75, -0.25, 0.25, 0.75}) rays.push_back(camera.RayThrough(x, y));
    }
    glm::dvec3 sum(0.0);
    const auto traced = *reference::TraceRays(**medium, surroundings, rays, {7, 1500, 0});
    for (const glm::dvec3& radiance : traced) sum += radiance;
    return sum / static_cast<double>(rays.size());
  }

  std::unique_ptr<gl::Context> context_;
  std::unique_ptr<SceneRenderer> renderer_;
  std::shared_ptr<const volume::HydrometeorFields> fields_ = MakeOvercast();
  scene::Scene scene_ = test_support::PlainScene();
};

TEST_F(GroundLightTest, AnOvercastGetsTheLightOfTheGroundInItsOwnShadow) {
  const glm::dvec3 over_black_ground = Drawn(0.0) / Traced(0.0);
  const glm::dvec3 over_snow = Drawn(0.9) / Traced(0.9);
  // The ratios to the reference are 0.77 in red, 0.85 in green and 0.99 in blue. The model uses one
  // fraction of lit ground for all colours (decision 48), but light that bounces between the ground
  // and a thick storm becomes redder.
  const glm::dvec3 tolerance_over_snow(0.26, 0.18, 0.04);
  for (int color = 0; color < 3; ++color) {
    // The ratios to the reference are 0.90 to 0.93. The difference is that of the diffusion
    // transport at a base 40 optical depths below the sunlit top.
    EXPECT_NEAR(over_black_ground[color], 1.0, 0.12) << color;
    EXPECT_NEAR(over_snow[color], 1.0, tolerance_over_snow[color]) << color;
  }
}

TEST_F(GroundLightTest, MoreHazeLightsTheGroundAnew) {
  // After a change of the sky alone, the picture is the same as when drawn from scratch.
  Drawn(0.9);
  scene_.sky.turbidity = 8.0;
  const glm::dvec3 changed = Drawn(0.9);
  renderer_ = std::make_unique<SceneRenderer>();
  const glm::dvec3 anew = Drawn(0.9);
  for (int color = 0; color < 3; ++color) EXPECT_NEAR(changed[color], anew[color], 1e-6) << color;
}

}  // namespace
}  // namespace thunderhead::renderers
