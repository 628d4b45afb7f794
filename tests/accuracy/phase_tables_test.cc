// Tests of tabulated phase functions in both renderers of a medium. Single scattering in a slab
// must follow each kind's curve in every colour, and a thin cloud of ice crystals must show its
// halos.
#include <cmath>
#include <memory>
#include <numbers>

#include "frame/tone_map.h"
#include "gl/context.h"
#include "glm/common.hpp"
#include "glm/trigonometric.hpp"
#include "gtest/gtest.h"
#include "physics/optics.h"
#include "renderers/half_angle/half_angle_renderer.h"
#include "renderers/light_volume/light_volume_renderer.h"
#include "tests/support/gl_context.h"
#include "tests/support/slab.h"
#include "tests/support/techniques.h"

namespace thunderhead::renderers {
namespace {

constexpr double kTableWidth_m = 40'000.0;
constexpr double kTableEye_m = 500.0;
constexpr double kOpticalDepth = 0.02;
constexpr int kTablePixels = 801;
constexpr double kHalfWidth_deg = 60.0;

// Extinction is stored in half floats, with an error of at most 2^-12. The light volume's light and
// picture are half floats too. Each adds as much error, in addition to the part of its optical
// depth that rounds down at the slab's face.
constexpr double kSlicingError = 1e-3;
constexpr double kMarchingError = 4e-3;

// The irradiance is so large that no half float of a picture is subnormal.
constexpr float kIrradiance = 100.0F;

// The lookup takes a value within a texel, or at most 0.09 degrees, of the correct angle. This
// smooths the sharp edges of halos and bows in the tables.
constexpr double kTexel_rad = 0.09 * std::numbers::pi / 180.0;

class PhaseTables : public testing::TestWithParam<physics::PhaseFunction> {
 protected:
  void SetUp() override {
    auto context = test_support::OpenContext();
    ASSERT_TRUE(context.ok()) << context.status();
    context_ = *std::move(context);
    test_support::SetMode(&scene_.rendering.technique, test_support::kLowAlbedo);
  }

  // Returns the angle between the middle of the picture and pixel `i`.
  static double Angle_rad(int i) {
    const double across = (i + 0.5) / kTablePixels * 2.0 - 1.0;
    return std::atan(std::abs(across) * std::tan(glm::radians(kHalfWidth_deg)));
  }

  // Returns a row of pixels seen from below a slab of cloud. The middle looks straight up to the
  // sun, or to the antisolar point if the sun shines straight from below (which needs no ground).
  std::vector<float> LookUp(double sun_elevation_deg, const accuracy::PlainTechnique& renderer) {
    const auto fields = support::MakeSlab(kTableWidth_m, kTableEye_m, kOpticalDepth / kTableEye_m);
    ResidentMedium::Cost cost;
    DetailNoises noises;
    const ResidentMedium medium(scene_, *fields, &noises, &cost);
    RenderSettings settings;
    settings.technique = scene_.rendering.technique;
    settings.view.eye_m = {0.0, 0.0, -3000.0};
    settings.view.forward = {0.0, 0.0, 1.0};
    settings.view.up = {0.0, -1.0, 0.0};
    settings.view.tan_half_width = std::tan(glm::radians(kHalfWidth_deg));
    settings.view.tan_half_height = 1e-3;
    settings.illumination = {scene::Direction(0.0, sun_elevation_deg), glm::vec3(kIrradiance),
                             glm::vec3(0.0F)};
    settings.eye_size = {kTablePixels, 1};
    settings.slices = 64;
    const auto programs = std::make_shared<gl::ProgramCache>();
    if (renderer == test_support::kHalfAngle) {
      HalfAngleRenderer half_angle(programs);
      EXPECT_TRUE(half_angle.Render(medium, settings, true).ok());
      return frame::ReadLinear(half_angle.Eye());
    }
    LightVolumeRenderer light_volume(programs);
    EXPECT_TRUE(light_volume.CarryLight(medium, settings).ok());
    EXPECT_TRUE(light_volume.DrawView(medium, settings).ok());
    return frame::ReadLinear(light_volume.Eye());
  }

  scene::Scene scene_ = test_support::PlainScene();

 private:
  std::unique_ptr<gl::Context> context_;
};

TEST_P(PhaseTables, SingleScatteringFollowsTheCurve) {
  scene_.fields[0].sizes = physics::SizeSource::kGiven;
  physics::ParticleOptics& cloud = scene_.fields[0].optics;
  cloud.phase = GetParam();
  // The slab's water content is for the default radius. Its optical depth is inversely proportional
  // to the radius.
  const double radius_ratio =
      cloud.phase.droplet_radius_m > 0.0F ? cloud.phase.droplet_radius_m / cloud.radius_m : 1.0;
  cloud.radius_m *= static_cast<float>(radius_ratio);
  const double depth = kOpticalDepth / radius_ratio;
  const physics::PhaseFunction phase = physics::PhaseOf(cloud);
  for (const auto& [sun_elevation_deg, renderer] :
       {std::pair(90.0, test_support::kHalfAngle), std::pair(-90.0, test_support::kHalfAngle),
        std::pair(90.0, test_support::kLightVolume),
        std::pair(-90.0, test_support::kLightVolume)}) {
    const std::vector<float> eye = LookUp(sun_elevation_deg, renderer);
    const double error = renderer == test_support::kHalfAngle ? kSlicingError : kMarchingError;
    double squares = 0.0;
    for (int i = 0; i < kTablePixels; ++i) {
      const double up = std::cos(Angle_rad(i));
      const double mu = sun_elevation_deg > 0.0 ? up : -up;
      // The sun is above or below the slab. The radiance is the integral over t of exp(-t / up)
      // times exp(-optical depth towards the sun).
      const double longer = std::fmax(1.0 / up - 1.0, 1e-9);
      const double seen = sun_elevation_deg > 0.0
                              ? std::exp(-depth) * -std::expm1(-depth * longer) / longer / up
                              : -std::expm1(-depth * (1.0 / up + 1.0)) / (1.0 + up);
      const double share = kIrradiance * seen / (4 * std::numbers::pi);
      const auto curve = [&](double away_rad) {
        return share * physics::PhaseColors(phase, std::cos(std::acos(mu) + away_rad));
      };
      const glm::dvec3 expected = curve(0.0);
      const glm::dvec3 low = glm::min(expected, glm::min(curve(-kTexel_rad), curve(kTexel_rad)));
      const glm::dvec3 high = glm::max(expected, glm::max(curve(-kTexel_rad), curve(kTexel_rad)));
      for (int c = 0; c < 3; ++c) {
        const double value = eye[4 * i + c];
        squares += (value / expected[c] - 1.0) * (value / expected[c] - 1.0) / (3.0 * kTablePixels);
        ASSERT_GE(value, low[c] * (1.0 - error)) << glm::degrees(std::acos(mu));
        ASSERT_LE(value, high[c] * (1.0 + error)) << glm::degrees(std::acos(mu));
      }
    }
    EXPECT_LT(std::sqrt(squares), 0.004) << "on average, in proportion";
  }
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, PhaseTables,
    testing::Values(physics::PhaseFunction{physics::PhaseKind::kHenyeyGreenstein, 0.85F},
                    physics::PhaseFunction{physics::PhaseKind::kCornetteShanks, 0.85F},
                    physics::PhaseFunction{physics::PhaseKind::kRayleigh},
                    physics::PhaseFunction{physics::PhaseKind::kWaterDroplets, 0.0F, 5e-6F},
                    physics::PhaseFunction{physics::PhaseKind::kWaterDroplets, 0.0F, 1e-5F},
                    physics::PhaseFunction{physics::PhaseKind::kWaterDroplets, 0.0F, 5e-4F},
                    physics::PhaseFunction{physics::PhaseKind::kIceColumns},
                    physics::PhaseFunction{physics::PhaseKind::kIcePlates},
                    physics::PhaseFunction{physics::PhaseKind::kIceRough}));

// The brightest angle between `low_deg` and `high_deg` in green light seen through equal depths of
// cloud, and how much brighter it is than the beginning of the halo.
struct Halo {
  double angle_deg = 0.0;
  double contrast = 0.0;
};

class Halos : public PhaseTables {
 protected:
  static Halo Brightest(const std::vector<float>& eye, double low_deg, double high_deg) {
    const auto source = [&](int i) { return eye[4 * i + 1] * std::cos(Angle_rad(i)); };
    Halo halo;
    double brightest = 0.0;
    double first = 0.0;
    for (int i = kTablePixels / 2; i < kTablePixels; ++i) {
      const double angle_deg = glm::degrees(Angle_rad(i));
      if (angle_deg < low_deg || angle_deg > high_deg) continue;
      if (first == 0.0) first = source(i);
      if (source(i) <= brightest) continue;
      brightest = source(i);
      halo = {angle_deg, brightest / first};
    }
    return halo;
  }
};

TEST_F(Halos, OfAThinIceCloudBeforeTheSun) {
  // Light is translucent with its forward peak cut, as in the default scene.
  test_support::SetMode(&scene_.rendering.technique, test_support::kPerFieldPhase);
  for (const auto& [kind, renderer] :
       {std::pair(physics::PhaseKind::kIceColumns, test_support::kHalfAngle),
        std::pair(physics::PhaseKind::kIcePlates, test_support::kHalfAngle),
        std::pair(physics::PhaseKind::kIceColumns, test_support::kLightVolume)}) {
    scene_.fields[0].optics.phase = {kind};
    const std::vector<float> eye = LookUp(90.0, renderer);
    const Halo inner = Brightest(eye, 20.0, 30.0);
    EXPECT_NEAR(inner.angle_deg, 22.25, 0.3);
    EXPECT_GT(inner.contrast, 2.0);
    const Halo outer = Brightest(eye, 44.0, 50.0);
    EXPECT_NEAR(outer.angle_deg, 46.25, 0.4);
    EXPECT_GT(outer.contrast, 1.2);
  }
  scene_.fields[0].optics.phase = {physics::PhaseKind::kIceRough};
  // Rough crystals have no halo: the brightest angle is next to the sun.
  EXPECT_NEAR(Brightest(LookUp(90.0, test_support::kHalfAngle), 20.0, 30.0).angle_deg, 20.0, 0.3);
}

}  // namespace
}  // namespace thunderhead::renderers
