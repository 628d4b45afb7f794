#include "renderers/metaball/ball_fit.h"
#include "renderers/metaball/metaball_renderer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "frame/tone_map.h"
#include "gl/context.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "physics/optics.h"
#include "renderers/scene_renderer.h"
#include "scene/view.h"
#include "tests/support/gl_context.h"
#include "tests/support/slab.h"
#include "tests/support/techniques.h"

namespace thunderhead::renderers {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr int kSide = 65;  // odd, so that a pixel lies in the middle
constexpr double kPi = std::numbers::pi;

// Returns the integral of Wyvill's field along a line at `u` radii from the middle, over the
// radius. This is eq. 12 of P. Man, "Generating and Real-Time Rendering of Clouds", except for the
// signs that are printed there. The integral is summed by midpoints.
double Column(double u) {
  constexpr int kSteps = 20000;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double z = -1.0 + (i + 0.5) * 2.0 / kSteps;
    const double a = u * u + z * z;
    if (a < 1.0) sum += 1.0 - 22.0 / 9.0 * a + 17.0 / 9.0 * a * a - 4.0 / 9.0 * a * a * a;
  }
  return sum * 2.0 / kSteps;
}

class MetaballTest : public testing::Test {
 protected:
  void SetUp() override {
    auto context = test_support::OpenContext();
    ASSERT_TRUE(context.ok()) << context.status();
    context_ = *std::move(context);
    renderer_ = std::make_unique<MetaballRenderer>(std::make_shared<gl::ProgramCache>());
    MediumGroup group;
    group.phase = {physics::PhaseKind::kHenyeyGreenstein, 0.0};
    content_.groups = {group};
    test_support::SetTechnique(&settings_.technique, test_support::kMetaball);
    // The mode is single scattering: scattered light is lost, and no direction is special.
    test_support::SetMode(&settings_.technique, test_support::kLowAlbedo);
    settings_.illumination = {{0.0, 0.0, 1.0}, glm::vec3(1.0F), glm::vec3(0.0F)};
    settings_.eye_size = glm::ivec2(kSide);
    LookDown(3000.0);
  }
  void TearDown() override {
    renderer_.reset();
    context_.reset();
  }

  // Makes rays parallel and straight down. The middle pixel's ray goes through x = y = 0.
  void LookDown(double width_m) {
    settings_.view = scene::ViewOf(scene::TopDownCamera{{0.0, 0.0}, width_m}, 1.0);
  }

  static Ball At(const glm::dvec3& middle_m, double radius_m, double extinction_per_m) {
    Ball ball;
    ball.middle_m = middle_m;
    ball.radius_m = radius_m;
    ball.extinction_per_m = extinction_per_m;
    return ball;
  }

  // Returns four floats for each pixel.
  std::vector<float> Draw(const std::vector<Ball>& balls) {
    const absl::Status lit = renderer_->CarryLight({balls, 0.0}, content_, settings_);
    EXPECT_TRUE(lit.ok()) << lit;
    return DrawAgain();
  }
  std::vector<float> DrawAgain() {
    const absl::Status drawn = renderer_->DrawView(settings_);
    EXPECT_TRUE(drawn.ok()) << drawn;
    return frame::ReadLinear(renderer_->Eye());
  }

  static std::size_t Pixel(int x, int y) { return 4 * static_cast<std::size_t>(y * kSide + x); }
  static constexpr std::size_t kMiddle = 4 * (kSide / 2 * kSide + kSide / 2);

  std::unique_ptr<gl::Context> context_;
  std::unique_ptr<MetaballRenderer> renderer_;
  Medium content_;
  RenderSettings settings_;
};

TEST_F(MetaballTest, OneBallsTransmittanceIsTheIntegralOfItsField) {
  for (const double depth : {1e-3, 0.5, 3.0}) {
    const std::vector<float> pixels = Draw({At({0.0, 0.0, 5000.0}, 1000.0, depth / 1000.0)});
    EXPECT_NEAR(pixels[kMiddle + 3], std::exp(-depth * Column(0.0)), 1e-6);
    for (const int x : {40, 46, 52}) {
      const double u = 3.0 * ((x + 0.5) / kSide - 0.5);
      EXPECT_NEAR(pixels[Pixel(x, kSide / 2) + 3], std::exp(-depth * Column(u)), 1e-5) << u;
    }
    EXPECT_EQ(pixels[Pixel(0, 0) + 3], 1.0F) << "beside the ball";
  }
}

TEST_F(MetaballTest, PerspectiveAndParallelRaysAgreeOnTheMiddle) {
  const std::vector<Ball> ball = {At({0.0, 0.0, 5000.0}, 1000.0, 1e-3)};
  const std::vector<float> parallel = Draw(ball);
  scene::OrbitCamera camera;
  camera.target_m = {0.0, 0.0, 5000.0};
  camera.azimuth_deg = 37.0;
  camera.elevation_deg = -20.0;
  for (const double distance_m : {1500.0, 3e4, 3e6}) {
    camera.distance_m = distance_m;
    camera.field_of_view_deg = 360.0 / kPi * std::atan(1200.0 / distance_m);
    settings_.view = scene::ViewOf(camera, 1.0);
    const std::vector<float> pixels = DrawAgain();
    EXPECT_NEAR(pixels[kMiddle + 3], parallel[kMiddle + 3], 2e-4) << distance_m;
    // The square covers the whole ball: its outline fills the picture's middle row at every
    // distance.
    const auto covered = [&](int x) { return pixels[Pixel(x, kSide / 2) + 3] < 1.0F; };
    EXPECT_TRUE(covered(6 * kSide / 32) && covered(26 * kSide / 32)) << distance_m;
  }
}

TEST_F(MetaballTest, AnEyeInsideABallSeesOnlyWhatIsBeforeIt) {
  scene::OrbitCamera camera;
  camera.target_m = {0.0, 0.0, 5000.0};
  camera.distance_m = 1e-3;
  settings_.view = scene::ViewOf(camera, 1.0);
  const std::vector<float> pixels = Draw({At({0.0, 0.0, 5000.0}, 1000.0, 1e-3)});
  for (std::size_t i = 3; i < pixels.size(); i += 4) {
    ASSERT_NEAR(pixels[i], std::exp(-0.5 * Column(0.0)), 1e-4);
  }
}

TEST_F(MetaballTest, TransmittancesOfBallsInLineMultiply) {
  const double column = Column(0.0);
  const std::vector<float> pixels =
      Draw({At({0.0, 0.0, 9000.0}, 1000.0, 4e-4), At({0.0, 0.0, 5000.0}, 500.0, 2e-3),
            At({0.0, 0.0, 5600.0}, 500.0, 1e-3)});  // overlapping
  EXPECT_NEAR(pixels[kMiddle + 3], std::exp(-column * (0.4 + 1.0 + 0.5)), 1e-6);
}

// The ball is seen and lit from above. The middle pixel shows the share of sunlight that is lost
// along its ray, scattered evenly in all directions.
TEST_F(MetaballTest, AThinBallScattersWhatItTakes) {
  const double depth = 1e-3;
  const std::vector<float> pixels = Draw({At({0.0, 0.0, 5000.0}, 1000.0, depth / 1000.0)});
  const double scattered = depth * Column(0.0) / (4 * kPi);
  EXPECT_NEAR(pixels[kMiddle] / scattered, 1.0, 2e-3);
}

TEST_F(MetaballTest, ABallScattersByThePhaseFunctionsOfItsShares) {
  MediumGroup forward;
  forward.phase = {physics::PhaseKind::kHenyeyGreenstein, 0.6F};
  content_.groups.push_back(forward);
  Ball ball = At({0.0, 0.0, 5000.0}, 1000.0, 1e-6);
  const auto seen = [&](float share) {
    ball.shares = {1.0F - share, share};
    return Draw({ball})[kMiddle];
  };
  // The view is straight down, so the light is deflected by 180 degrees minus the sun's zenith
  // angle.
  for (const double zenith_deg : {0.0, 60.0, 120.0, 179.0}) {
    const double zenith = zenith_deg * kPi / 180.0;
    settings_.illumination.towards_sun = {std::sin(zenith), 0.0, std::cos(zenith)};
    const double phase = physics::PhaseValue(forward.phase, -std::cos(zenith));
    EXPECT_NEAR(seen(1.0F) / seen(0.0F), phase, 2e-3 * phase) << zenith_deg;
    EXPECT_NEAR(seen(0.25F) / seen(0.0F), 0.75 + 0.25 * phase, 2e-3 * phase) << zenith_deg;
  }
}

TEST_F(MetaballTest, LightThatABallTakesIsLightThatItHas) {
  // Parallel light falls on the ball. Of the light of a pixel with optical depth d, the ball takes
  // the share 1 - exp(-d), however thick it is. The light taken from all pixels is distributed over
  // the ball in proportion to its matter.
  for (const double depth : {0.1, 2.0, 50.0}) {
    const std::vector<float> pixels = Draw({At({0.0, 0.0, 5000.0}, 1000.0, depth / 1000.0)});
    double taken = 0.0;
    double matter = 0.0;
    constexpr int kRings = 2000;
    for (int i = 0; i < kRings; ++i) {
      const double u = (i + 0.5) / kRings;
      const double s = 1.0 - u * u;
      const double column = std::pow(s, 2.5) * (16.0 / 27.0 + 128.0 / 315.0 * s);
      taken += u * -std::expm1(-depth * column);
      matter += u * depth * column;
    }
    const double arrives = taken / matter;
    const double seen = -std::expm1(-depth * Column(0.0)) / (4 * kPi) * arrives;
    // The tolerance allows for the light buffer, which is only about 64 texels wide.
    EXPECT_NEAR(pixels[kMiddle] / seen, 1.0, 0.02) << depth;
  }
}

TEST_F(MetaballTest, ABallInAnothersShadowHasWhatPasses) {
  // The sun shines along x. Seen from above, the far ball lies next to the near one.
  settings_.illumination.towards_sun = {1.0, 0.0, 0.0};
  LookDown(8000.0);
  const Ball lit = At({2000.0, 0.0, 5000.0}, 1000.0, 1e-6);
  const Ball thick = At({2000.0, 0.0, 5000.0}, 1000.0, 2e-3);
  // The ball `behind` is so small that all of it lies behind the middle of the large ball. It is
  // drawn in the middle of a pixel.
  constexpr int kColumn = kSide / 4;
  const double east_m = ((kColumn + 0.5) / kSide - 0.5) * 8000.0;
  const Ball behind = At({east_m, 0.0, 5000.0}, 50.0, 1e-3);
  const std::size_t at = Pixel(kColumn, kSide / 2);
  const float free = Draw({behind})[at];
  EXPECT_NEAR(Draw({behind, lit})[at] / free, 1.0, 5e-3);
  EXPECT_NEAR(Draw({behind, thick})[at] / free, std::exp(-2.0 * Column(0.0)), 5e-3);
  // With the sun on the other side, the large ball lies in the shadow of the small one. The light
  // buffer has a new layout, so its texels meet the small ball at other places.
  settings_.illumination.towards_sun = {-1.0, 0.0, 0.0};
  EXPECT_NEAR(Draw({behind, thick})[at] / free, 1.0, 1e-4);
}

TEST_F(MetaballTest, TheNearestBallIsDrawnLast) {
  // The light is grey, so one colour channel is compared. The ball in front hides the ball behind
  // it, from either side and in any order of the list. The upper ball is lit, and the lower ball
  // lies in its shadow.
  const Ball upper = At({0.0, 0.0, 8000.0}, 1000.0, 20e-3);
  const Ball lower = At({0.0, 0.0, 4000.0}, 1000.0, 20e-3);
  const float above = Draw({upper, lower})[kMiddle];
  EXPECT_EQ(Draw({lower, upper})[kMiddle], above);
  scene::OrbitCamera camera;
  camera.target_m = {0.0, 0.0, 6000.0};
  camera.elevation_deg = -89.9;
  camera.distance_m = 50e3;
  camera.field_of_view_deg = 2.0;
  settings_.view = scene::ViewOf(camera, 1.0);
  const float below = Draw({upper, lower})[kMiddle];
  EXPECT_EQ(Draw({lower, upper})[kMiddle], below);
  // A tenth of the light passes the rim of the upper ball.
  EXPECT_GT(above, 5.0F * below);
}

TEST_F(MetaballTest, PaperTransportIsAsPrinted) {
  test_support::SetTransport(&settings_.technique, scene::Transport::kPaper);
  test_support::MetaballsOf(settings_.technique).isotropic = true;
  LookDown(8000.0);
  const double albedo = test_support::MetaballsOf(settings_.technique).albedo;
  const double tau = test_support::MetaballsOf(settings_.technique).optical_depth;
  const Ball ball = At({0.0, 0.0, 5000.0}, 1000.0, 1.0);
  // A single ball in white light has the radiance of Man's eq. 26 with p = 1. Its optical depth at
  // a pixel is `tau` times eq. 12.
  const std::vector<float> one = Draw({ball});
  EXPECT_NEAR(one[kMiddle], albedo * tau / (4 * kPi), 1e-3);
  EXPECT_NEAR(one[kMiddle + 3], std::exp(-tau), 1e-5);
  // Rayleigh's function is 3/2 straight back and 3/4 across.
  test_support::MetaballsOf(settings_.technique).isotropic = false;
  EXPECT_NEAR(Draw({ball})[kMiddle] / one[kMiddle], 1.5, 1e-4);
  settings_.illumination.towards_sun = {1.0, 0.0, 0.0};
  EXPECT_NEAR(Draw({ball})[kMiddle] / one[kMiddle], 0.75, 1e-4);
  // Two balls are in line with the light. The second receives the mean of Man's eq. 27 over its
  // disc. This is g + T I: the light g that the first ball scatters straight on, and the share T of
  // the sunlight I that passes through it.
  Ball behind = ball;
  behind.middle_m.x -= 3000.0;
  double mean = 0.0;
  double area = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const double u = (i + 0.5) / 2000;
    const double a = u * u;
    const double depth = tau * (1.0 - 22.0 / 9.0 * a + 17.0 / 9.0 * a * a - 4.0 / 9.0 * a * a * a);
    mean += u * (albedo * depth * 1.5 / (4 * kPi) + std::exp(-depth));
    area += u;
  }
  test_support::MetaballsOf(settings_.technique).isotropic = true;
  const std::vector<float> two = Draw({ball, behind});
  const int x = static_cast<int>((0.5 - 3000.0 / 8000.0) * kSide);
  const double off = (3000.0 + 8000.0 * ((x + 0.5) / kSide - 0.5)) / 1000.0;
  const double s = 1.0 - off * off;
  const double field = s * s * (5.0 + 4.0 * s) / 9.0;
  EXPECT_NEAR(two[Pixel(x, kSide / 2)] / (albedo * tau * field / (4 * kPi)), mean / area, 0.02);
}

TEST_F(MetaballTest, SkyAndGroundLightFromBothSides) {
  settings_.illumination.sunlight = glm::vec3(0.0F);
  settings_.illumination.from_sky = {0.2F, 0.3F, 0.9F};
  settings_.illumination.from_ground = {0.2F, 0.1F, 0.05F};
  // A white furnace: with the same light on both sides, the cloud is as bright as its surroundings
  // wherever it is opaque.
  RenderSettings furnace = settings_;
  furnace.illumination.from_ground = furnace.illumination.from_sky;
  std::swap(settings_, furnace);
  std::vector<Ball> balls;
  for (int i = 0; i < 20; ++i) balls.push_back(At({0.0, 0.0, 2000.0 + 300.0 * i}, 1000.0, 5e-3));
  const std::vector<float> even = Draw(balls);
  EXPECT_NEAR(even[kMiddle], 0.2, 1e-4);
  EXPECT_NEAR(even[kMiddle + 2], 0.9, 1e-4);
  std::swap(settings_, furnace);
  const std::vector<float> from_above = Draw(balls);
  EXPECT_GT(from_above[kMiddle + 2], 0.8F) << "its top has the sky's colour";
}

class MetaballLightsTest : public MetaballTest {
 protected:
  void SetUp() override {
    MetaballTest::SetUp();
    test_support::SetMode(&settings_.technique, test_support::kPerFieldPhase);
    settings_.illumination = {{0.0, 0.6, 0.8}, glm::vec3(0.0F), glm::vec3(0.0F)};
    balls_.push_back(At({0.0, 0.0, 5200.0}, 500.0, 4e-3));
    for (int i = 0; i < 30; ++i) {
      const double angle = 0.7 * i;
      balls_.push_back(At({900.0 * std::cos(angle), 900.0 * std::sin(angle), 4000.0 + 60.0 * i},
                          300.0 + 10.0 * i, 4e-3));
    }
  }

  std::vector<float> DrawWith(const std::vector<Beam>& beams) {
    settings_.illumination.beams = beams;
    return Draw(balls_);
  }

  const Beam red_{glm::normalize(glm::dvec3(1.0, 0.0, 0.4)), {0.9F, 0.1F, 0.0F}};
  const Beam blue_{glm::normalize(glm::dvec3(-0.3, -1.0, 0.1)), {0.0F, 0.2F, 2.0F}};
  std::vector<Ball> balls_;
};

TEST_F(MetaballLightsTest, LightsAddUp) {
  for (const auto transport : {scene::Transport::kConsistent, scene::Transport::kPaper}) {
    test_support::SetTransport(&settings_.technique, transport);
    settings_.illumination.sunlight = glm::vec3(0.0F);
    const std::vector<float> red = DrawWith({red_});
    const std::vector<float> blue = DrawWith({blue_});
    settings_.illumination.sunlight = {0.5F, 0.6F, 0.7F};
    const std::vector<float> sun = DrawWith({});
    const std::vector<float> all = DrawWith({red_, blue_});
    double brightest = 0.0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (i % 4 == 3) {
        ASSERT_EQ(all[i], sun[i]);
        continue;
      }
      // The sums have three terms in single precision.
      ASSERT_NEAR(all[i], sun[i] + red[i] + blue[i], 1e-6 * (1.0 + all[i]));
      brightest = std::max<double>(brightest, all[i]);
    }
    EXPECT_GT(brightest, 0.05);
    EXPECT_GT(red[kMiddle], 5.0F * red[kMiddle + 1]) << "in its own colour";
    EXPECT_EQ(red[kMiddle + 2], 0.0F);
    EXPECT_GT(blue[kMiddle + 2], 5.0F * blue[kMiddle + 1]);
  }
}

TEST_F(MetaballLightsTest, ALightInTheSunsPlaceIsTheSun) {
  settings_.illumination.sunlight = glm::vec3(0.7F);
  const std::vector<float> sun = DrawWith({});
  settings_.illumination.sunlight = glm::vec3(0.0F);
  EXPECT_EQ(DrawWith({{settings_.illumination.towards_sun, glm::vec3(0.7F)}}), sun);
}

TEST_F(MetaballLightsTest, LightsFromAnywhereStaySound) {
  const glm::vec3 strongest(100.0F);
  // The lights are as many as a scene may have: straight down, straight up, from the eye and from
  // the sun's place.
  const std::vector<Beam> beams = {{{0.0, 0.0, 1.0}, strongest},
                                   {{0.0, 0.0, -1.0}, strongest},
                                   {-settings_.view.forward, glm::vec3(0.0F)},
                                   {settings_.illumination.towards_sun, strongest}};
  for (const auto transport : {scene::Transport::kConsistent, scene::Transport::kPaper}) {
    test_support::SetTransport(&settings_.technique, transport);
    const std::vector<float> pixels = DrawWith(beams);
    float brightest = 0.0F;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      ASSERT_TRUE(std::isfinite(pixels[i]));
      ASSERT_GE(pixels[i], 0.0F);
      if (i % 4 != 3) brightest = std::max(brightest, pixels[i]);
    }
    // The bound is the irradiance of all three lights.
    EXPECT_LE(brightest, 300.0F);
    EXPECT_GT(brightest, 1.0F);
  }
}

TEST_F(MetaballLightsTest, OnlyWhatChangedIsCarriedAgain) {
  settings_.illumination.sunlight = glm::vec3(0.3F);
  const auto check = [&](const std::vector<Beam>& beams, int carried, const std::string& what) {
    const std::vector<float> pixels = DrawWith(beams);
    EXPECT_EQ(renderer_->CarriedLights(), carried) << what;
    MetaballRenderer fresh(std::make_shared<gl::ProgramCache>());
    std::swap(*renderer_, fresh);
    EXPECT_EQ(DrawWith(beams), pixels) << what;
    std::swap(*renderer_, fresh);
  };
  check({red_}, 3, "the sun, one light, sky and ground");
  check({red_}, 0, "nothing");
  check({red_, blue_}, 1, "another light");
  Beam dimmed = blue_;
  dimmed.irradiance *= 0.1F;
  check({red_, dimmed}, 0, "its colour");
  check({dimmed, red_}, 0, "the order");
  check({red_}, 0, "one less");
  settings_.illumination.towards_sun = {0.0, -0.6, 0.8};
  check({red_}, 1, "the sun");
  settings_.illumination.from_sky = {0.1F, 0.2F, 0.3F};
  check({red_}, 0, "the sky's colour");
  test_support::MetaballsOf(settings_.technique).isotropic = true;
  check({red_}, 0, "what the eye sees of it");
  balls_[3].radius_m += 1.0;
  check({red_}, 3, "a ball");
  test_support::SetMode(&settings_.technique, test_support::kLowAlbedo);
  check({red_}, 3, "how light goes on");
  test_support::SetTransport(&settings_.technique, scene::Transport::kPaper);
  check({red_, blue_}, 5, "the paper's, with two lights for sky and ground");
  test_support::MetaballsOf(settings_.technique).albedo = 0.5;
  check({red_, blue_}, 5, "the paper's albedo");
  test_support::MetaballsOf(settings_.technique).optical_depth = 5.0;
  check({red_, blue_}, 5, "the paper's depth");
}

TEST_F(MetaballTest, NoBallsAreNothing) {
  for (const auto transport : {scene::Transport::kPaper, scene::Transport::kConsistent}) {
    test_support::SetTransport(&settings_.technique, transport);
    const std::vector<float> pixels = Draw({});
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      ASSERT_EQ(pixels[i], i % 4 == 3 ? 1.0F : 0.0F);
    }
  }
  EXPECT_TRUE(renderer_->Box().Empty());
}

TEST_F(MetaballTest, WhatIsNoBallIsRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Ball& ball : {At({0.0, 0.0, 0.0}, -1.0, 1.0), At({0.0, 0.0, 0.0}, 0.0, 1.0),
                           At({0.0, 0.0, 0.0}, 1.0, -1.0), At({0.0, nan, 0.0}, 1.0, 1.0),
                           At({0.0, 0.0, 0.0}, nan, 1.0), At({0.0, 0.0, 0.0}, 1.0, 1.0 / 0.0)}) {
    const absl::Status status =
        renderer_->CarryLight({{At({0.0, 0.0, 0.0}, 1.0, 1.0), ball}, 0.0}, content_, settings_);
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(status.message(), HasSubstr("ball 1"));
  }
}

TEST_F(MetaballTest, ExtremesStaySound) {
  const auto sound = [&](const std::vector<Ball>& balls, const std::string& what,
                         double most_passes = 1.0) {
    const std::vector<float> pixels = Draw(balls);
    EXPECT_LE(pixels[kMiddle + 3], most_passes) << what;
    EXPECT_GT(pixels[kMiddle], 0.0F) << what;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      ASSERT_TRUE(std::isfinite(pixels[i])) << what << ' ' << i;
      ASSERT_GE(pixels[i], 0.0F) << what;
      // The sun's unit irradiance is the only light, so it is the bound.
      ASSERT_LE(pixels[i], 1.0F) << what;
    }
  };
  for (const auto transport : {scene::Transport::kPaper, scene::Transport::kConsistent}) {
    test_support::SetTransport(&settings_.technique, transport);
    sound({At({0.0, 0.0, 0.0}, 1e7, 1.0)}, "one huge ball", 0.01);
    sound({At({0.0, 0.0, 0.0}, 1e7, 1e-3), At({0.0, 0.0, 5000.0}, 1e-2, 1e3)}, "huge and tiny",
          0.01);
    sound(std::vector<Ball>(500, At({0.0, 0.0, 5000.0}, 500.0, 1e-3)), "all in one place", 0.01);
    sound({At({0.0, 0.0, 5000.0}, 1000.0, 1e8)}, "a wall", 0.01);
    sound({At({0.0, 0.0, 5000.0}, 1000.0, 1e-12)}, "hardly anything");
    sound({At({0.0, 0.0, 5000.0}, 1e-3, 1.0), At({900.0, 0.0, 7000.0}, 1e-3, 1.0)}, "points");
  }
}

class MetaballSceneTest : public testing::Test {
 protected:
  void SetUp() override {
    auto context = test_support::OpenContext();
    ASSERT_TRUE(context.ok()) << context.status();
    context_ = *std::move(context);
    renderer_ = std::make_unique<SceneRenderer>();
    scene_.output = {48, 32, 90};
    test_support::SetTechnique(&scene_.rendering.technique, test_support::kMetaball);
    test_support::MetaballsOf(scene_.rendering.technique).count = 60;
    auto& orbit = std::get<scene::OrbitCamera>(scene_.camera);
    orbit.target_m = {0.0, 0.0, 1000.0};
    orbit.distance_m = 12e3;
  }
  void TearDown() override {
    renderer_.reset();
    context_.reset();
  }

  LinearFrame Draw() {
    auto frame = renderer_->Draw(scene_, fields_, {});
    EXPECT_TRUE(frame.ok()) << frame.status();
    return *std::move(frame);
  }
  std::vector<std::string> Stages() {
    std::vector<std::string> names;
    for (const scene::StageTime& stage : Draw().stages)
      names.push_back(std::string(scene::NameOf(stage.stage)));
    return names;
  }

  std::unique_ptr<gl::Context> context_;
  std::unique_ptr<SceneRenderer> renderer_;
  std::shared_ptr<const volume::HydrometeorFields> fields_ =
      support::MakeLayerInAir(4000.0, 2000.0, 8, 5.0);
  scene::Scene scene_ = test_support::PlainScene();
};

TEST_F(MetaballSceneTest, AChangeRerunsOnlyWhatItDirties) {
  EXPECT_THAT(Stages(), ElementsAre("extinction", "upload", "fit", "light", "ground", "view", "air",
                                    "composite"));
  EXPECT_THAT(Stages(), IsEmpty());
  std::get<scene::OrbitCamera>(scene_.camera).azimuth_deg += 5.0;
  EXPECT_THAT(Stages(), ElementsAre("view", "air", "composite"));
  scene_.sun.elevation_deg += 5.0;
  EXPECT_THAT(Stages(), ElementsAre("light", "ground", "view", "air", "composite"));
  test_support::MetaballsOf(scene_.rendering.technique).isotropic = true;
  EXPECT_THAT(Stages(), Not(Contains("fit")));
  test_support::MetaballsOf(scene_.rendering.technique).count = 80;
  EXPECT_THAT(Stages(), ElementsAre("fit", "light", "ground", "view", "air", "composite"));
  test_support::MetaballsOf(scene_.rendering.technique).count = 60;
  EXPECT_THAT(Stages(), Not(Contains("fit"))) << "it is kept";
  scene_.fields[0].scale = 2.0F;
  EXPECT_THAT(Stages(), Contains("fit"));
}

TEST_F(MetaballSceneTest, KeptStagesGiveThePictureThatAFreshRendererGives) {
  const auto pixels = [&](SceneRenderer* renderer) {
    const auto frame = renderer->Draw(scene_, fields_, {});
    EXPECT_TRUE(frame.ok()) << frame.status();
    return frame::ReadLinear(*frame->radiance);
  };
  const auto check = [&](const std::string& what) {
    SceneRenderer fresh;
    EXPECT_EQ(pixels(renderer_.get()), pixels(&fresh)) << what;
  };
  for (const auto transport : {scene::Transport::kConsistent, scene::Transport::kPaper}) {
    test_support::SetTransport(&scene_.rendering.technique, transport);
    check("transport");
    scene_.sky.turbidity += 2.0;
    check("turbidity");
    scene_.sky.brightness *= 0.5;
    check("sky");
    scene_.camera = scene::TopDownCamera{{0.0, 0.0}, 9e3};
    check("camera");
    scene_.sun.azimuth_deg += 90.0;
    check("sun");
    bool& false_colors = scene::MediumSettingsOf(&scene_.rendering.technique)->look.false_colors;
    false_colors = !false_colors;
    check("false colours");
    test_support::SetTechnique(&scene_.rendering.technique, test_support::kLightVolume);
    check("another renderer");
    test_support::SetTechnique(&scene_.rendering.technique, test_support::kMetaball);
    test_support::MetaballsOf(scene_.rendering.technique).count = 60;
    check("and back");
  }
}

std::vector<std::string> NotShown(const LinearFrame& frame) {
  std::vector<std::string> messages;
  for (const scene::NotShown& entry : frame.content.not_shown) messages.push_back(entry.message);
  return messages;
}

TEST_F(MetaballSceneTest, TheFrameSaysWhatItIs) {
  const LinearFrame frame = Draw();
  EXPECT_GT(frame.content.balls, 10);
  EXPECT_LE(frame.content.balls, 60);
  EXPECT_GT(frame.content.fit_error, 0.0);
  EXPECT_LT(frame.content.fit_error, 0.5);
  EXPECT_EQ(frame.slices, 0);
  // The noise on the metaballs replaces turbulent detail, so only other fine structure is reported
  // as missing.
  EXPECT_THAT(NotShown(frame),
              ElementsAre("structure finer than the metaballs, except noise on their surfaces"));
  test_support::SetTransport(&scene_.rendering.technique, scene::Transport::kPaper);
  EXPECT_THAT(NotShown(Draw()), Contains(HasSubstr("albedo")));
  test_support::SetTechnique(&scene_.rendering.technique, test_support::kLightVolume);
  EXPECT_THAT(NotShown(Draw()), IsEmpty());
  EXPECT_EQ(Draw().content.balls, 0);
}

TEST_F(MetaballSceneTest, LightsBesidesTheSunAreShownOrSaidNotToBe) {
  const auto blue_over_red = [](const LinearFrame& frame) {
    const std::vector<float> pixels = frame::ReadLinear(*frame.radiance);
    const std::size_t middle = 4 * (16 * 48 + 24);
    return pixels[middle + 2] / pixels[middle];
  };
  const float plain = blue_over_red(Draw());
  scene_.lights = {{200.0, 10.0, {0.0, 0.0, 1.0}, 1.0}};
  const LinearFrame lit = Draw();
  EXPECT_THAT(NotShown(lit), Not(Contains(HasSubstr("lights"))));
  EXPECT_GT(blue_over_red(lit), 1.5F * plain);
  EXPECT_THAT(Stages(), IsEmpty());
  scene_.lights[0].color = {0.0, 1.0, 0.0};
  EXPECT_THAT(Stages(), ElementsAre("view", "air", "composite"));
  scene_.lights[0].azimuth_deg += 10.0;
  EXPECT_THAT(Stages(), ElementsAre("light", "view", "air", "composite"))
      << "the ground has no part in it";
  for (const auto renderer :
       {test_support::kLightVolume, test_support::kHalfAngle, test_support::kCumulus}) {
    test_support::SetTechnique(&scene_.rendering.technique, renderer);
    EXPECT_THAT(NotShown(Draw()), Contains(HasSubstr("lights in addition to the sun")));
    scene_.lights.clear();
    EXPECT_THAT(Stages(), IsEmpty()) << "none to draw again";
    EXPECT_THAT(NotShown(Draw()), Not(Contains(HasSubstr("lights"))));
    scene_.lights.emplace_back();
  }
}

TEST_F(MetaballSceneTest, TheirNoiseIsOfAFieldThatIsDrawn) {
  const auto pixels = [&](float clouds_share, float rains_share) {
    scene_.fields[physics::IndexOf(physics::Hydrometeor::kCloud)].detail.share = clouds_share;
    scene_.fields[physics::IndexOf(physics::Hydrometeor::kRain)].detail.share = rains_share;
    return frame::ReadLinear(*Draw().radiance);
  };
  for (scene::FieldParameters& field : scene_.fields) field.detail.share = 0.0F;
  const std::vector<float> smooth = pixels(0.0F, 0.0F);
  EXPECT_NE(pixels(1.0F, 0.0F), smooth);
  EXPECT_EQ(pixels(0.0F, 1.0F), smooth) << "the storm has no rain";
}

TEST_F(MetaballSceneTest, NothingVisibleNeedsNoBalls) {
  scene_.fields[0].visible = false;
  EXPECT_THAT(Stages(), Not(Contains("light")));
  EXPECT_EQ(Draw().content.balls, 0);
}

TEST_F(MetaballSceneTest, IsNearTheLightVolume) {
  scene_.camera = scene::TopDownCamera{{0.0, 0.0}, 8e3};
  for (scene::FieldParameters& field : scene_.fields) field.detail.share = 0.0F;
  const auto mean = [&](const accuracy::PlainTechnique& renderer) {
    test_support::SetTechnique(&scene_.rendering.technique, renderer);
    if (auto* metaballs = std::get_if<scene::Metaballs>(&scene_.rendering.technique)) {
      metaballs->count = 2000;
    }
    const std::vector<float> pixels = frame::ReadLinear(*Draw().radiance);
    double sum = 0.0;
    for (int y = 10; y < 22; ++y) {
      for (int x = 18; x < 30; ++x) sum += pixels[4 * static_cast<std::size_t>(48 * y + x)];
    }
    return sum / 144.0;
  };
  // The tolerance allows for the error of the fit, and for light that does not vary within a ball.
  // Both pictures have no detail, as in PlainScene's light volume.
  EXPECT_NEAR(mean(test_support::kMetaball) / mean(test_support::kLightVolume), 1.0, 0.15);
}

TEST(BallFits, KeepsWhatItsStormAndOpticsAskFor) {
  BallFits fits(2);
  scene::Scene scene = test_support::PlainScene();
  test_support::SetTechnique(&scene.rendering.technique, test_support::kMetaball);
  test_support::MetaballsOf(scene.rendering.technique).count = 20;
  auto fields = support::MakeLayerInAir(4000.0, 2000.0, 8, 5.0);
  EXPECT_FALSE(fits.Has(scene, fields));
  const auto first = fits.Get(scene, fields);
  ASSERT_TRUE(first.ok()) << first.status();
  EXPECT_TRUE(fits.Has(scene, fields));
  EXPECT_EQ(*fits.Get(scene, fields), *first);
  // A similar storm is still another storm, so its fit is not known.
  EXPECT_FALSE(fits.Has(scene, support::MakeLayerInAir(4000.0, 2000.0, 8, 5.0)));
  scene::Scene thinner = scene;
  thinner.fields[0].scale = 0.5F;
  ASSERT_TRUE(fits.Get(thinner, fields).ok());
  thinner.fields[0].scale = 0.25F;
  ASSERT_TRUE(fits.Get(thinner, fields).ok());
  EXPECT_FALSE(fits.Has(scene, fields)) << "only two are kept";
}

TEST(FitBalls, TheSumOfBallsIsTheMedium) {
  const auto fields = support::MakeLayerInAir(4000.0, 2000.0, 8, 5.0);
  scene::Scene scene = test_support::PlainScene();
  const Medium medium = scene::GroupedFieldsOf(scene, *fields);
  const auto cloud = FitBalls(medium, *fields, 300);
  ASSERT_TRUE(cloud.ok());
  double sum = 0.0;
  for (const Ball& ball : cloud->balls) {
    // The field's integral over a ball of radius 1 is 4 pi times 1/3 - 22/45 + 17/63 - 4/81.
    const double volume = 4 * kPi * (1.0 / 3 - 22.0 / 45 + 17.0 / 63 - 4.0 / 81);
    sum += ball.extinction_per_m * std::pow(ball.radius_m, 3.0) * volume;
    EXPECT_FLOAT_EQ(ball.shares[0], 1.0F);
    EXPECT_GT(ball.radius_m, 0.0);
    EXPECT_GE(ball.extinction_per_m, 0.0);
  }
  // The layer is 4 x 4 km wide and has optical depth 5. The tolerance allows for balls that extend
  // beyond the domain, where there are no cells to fit.
  EXPECT_NEAR(sum / (5.0 * 4000.0 * 4000.0), 1.0, 0.2);
  // If more balls than cells are requested, there are as many balls as cells.
  const auto few = support::MakeSlab(100.0, 100.0, 0.01, glm::ivec3(2));
  EXPECT_LE(FitBalls(scene::GroupedFieldsOf(scene, *few), *few, 1000)->balls.size(), 8U);
  EXPECT_THAT(FitBalls({}, *fields, 10)->balls, IsEmpty());
}

}  // namespace
}  // namespace thunderhead::renderers
