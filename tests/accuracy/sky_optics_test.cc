// Tests of the sky around and opposite to the sun, in drawn pictures of thin slabs. They compare
// the angles and colour orders of bows, glory, corona and aureole with published ones.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "frame/tone_map.h"
#include "gl/context.h"
#include "glm/trigonometric.hpp"
#include "gtest/gtest.h"
#include "physics/aureole.h"
#include "physics/optics.h"
#include "physics/refractive_index.h"
#include "physics/sky.h"
#include "renderers/light_volume/light_volume_renderer.h"
#include "renderers/sun_glow.h"
#include "tests/support/gl_context.h"
#include "tests/support/slab.h"
#include "tests/support/techniques.h"

namespace thunderhead::renderers {
namespace {

constexpr int kPixels = 1601;
constexpr double kWidth_m = 40'000.0;
constexpr double kHeight_m = 500.0;
constexpr int kRed = 0;
constexpr int kBlue = 2;

class SkyOptics : public testing::Test {
 protected:
  struct Look {
    physics::PhaseKind kind = physics::PhaseKind::kWaterDroplets;
    double radius_m = 1e-5;
    double optical_depth = 0.02;
    bool opposite = false;  // the sun is behind the viewer
    double half_width_deg = 60.0;
  };

  static void SetUpTestSuite() {
    auto context = test_support::OpenContext();
    ASSERT_TRUE(context.ok()) << context.status();
    context_ = *std::move(context);
  }
  static void TearDownTestSuite() { context_.reset(); }

  // Returns the angle from the sun or from the antisolar point, whichever is in the picture's
  // middle.
  double Angle_deg(int i) const {
    const double across = (i + 0.5) / kPixels * 2.0 - 1.0;
    return glm::degrees(std::atan(std::abs(across) * std::tan(glm::radians(half_width_deg_))));
  }

  // Draws a row of pixels looking straight up from below a slab. The default scene's modes apply:
  // the forward peak is cut, and the sun's glow is added.
  void Draw(const Look& look) {
    half_width_deg_ = look.half_width_deg;
    scene::Scene scene = test_support::PlainScene();
    test_support::SetMode(&scene.rendering.technique, test_support::kPerFieldPhase);
    physics::ParticleOptics& cloud = scene.fields[0].optics;
    const double usual_m = cloud.radius_m;
    scene.fields[0].sizes = physics::SizeSource::kGiven;
    cloud.phase = {look.kind};
    cloud.radius_m = static_cast<float>(look.radius_m);
    const auto fields = support::MakeSlab(kWidth_m, kHeight_m,
                                          look.optical_depth / kHeight_m * look.radius_m / usual_m);
    ResidentMedium::Cost cost;
    DetailNoises noises;
    const ResidentMedium medium(scene, *fields, &noises, &cost);
    RenderSettings settings;
    settings.technique = scene.rendering.technique;
    settings.view.eye_m = {0.0, 0.0, -3000.0};
    settings.view.forward = {0.0, 0.0, 1.0};
    settings.view.up = {0.0, -1.0, 0.0};
    settings.view.tan_half_width = std::tan(glm::radians(half_width_deg_));
    settings.view.tan_half_height = settings.view.tan_half_width / kPixels;
    const glm::dvec3 towards_sun = scene::Direction(0.0, look.opposite ? -90.0 : 90.0);
    settings.illumination = {towards_sun, glm::vec3(1.0F), glm::vec3(0.0F)};
    settings.eye_size = {kPixels, 1};
    settings.slices = 64;
    settings.quality.single_precision = true;
    const auto programs = std::make_shared<gl::ProgramCache>();
    LightVolumeRenderer light_volume(programs);
    ASSERT_TRUE(light_volume.CarryLight(medium, settings).ok());
    ASSERT_TRUE(light_volume.DrawView(medium, settings).ok());
    row_ = frame::ReadLinear(light_volume.Eye());
    gl::Texture2D glow(GL_RGBA32F, settings.eye_size);
    const gl::Framebuffer target(glow);
    target.Clear(0.0F, 0.0F, 0.0F, 0.0F);
    SunGlow sun(programs);
    Ground ground(programs);
    ground.SetTerrain(*fields);
    const absl::Status added = sun.AddThrough(
        medium, scene::MediumSettingsOrDefault(scene.rendering.technique), 64,
        {towards_sun, glm::vec3(1.0F)}, settings.view, &ground, {target, settings.eye_size});
    ASSERT_TRUE(added.ok()) << added;
    const std::vector<float> of_glow = frame::ReadLinear(glow);
    for (std::size_t i = 0; i < row_.size(); ++i) row_[i] += of_glow[i];
  }

  // Returns the radiance divided by the slab's depth along the ray.
  double At(int i, int color) const {
    return row_[static_cast<std::size_t>(4 * i + color)] * std::cos(glm::radians(Angle_deg(i)));
  }
  double AtAngle(double angle_deg, int color) const {
    int i = kPixels / 2;
    while (i < kPixels - 1 && Angle_deg(i) < angle_deg) ++i;
    return At(i, color);
  }

  struct Extreme {
    double angle_deg = 0.0;
    double value = 0.0;
  };
  Extreme Brightest(int color, double from_deg, double to_deg, double sign = 1.0) const {
    Extreme found{0.0, -1e30};
    for (int i = kPixels / 2; i < kPixels; ++i) {
      if (Angle_deg(i) < from_deg || Angle_deg(i) > to_deg) continue;
      if (sign * At(i, color) > found.value) found = {Angle_deg(i), sign * At(i, color)};
    }
    return {found.angle_deg, sign * found.value};
  }
  Extreme Darkest(int color, double from_deg, double to_deg) const {
    return Brightest(color, from_deg, to_deg, -1.0);
  }

  // Returns the bright ring nearest to the middle, smoothed over a few pixels on either side.
  Extreme FirstRing(int color) const {
    constexpr int kAside = 8;
    for (int i = kPixels / 2 + kAside; i + kAside < kPixels; ++i) {
      bool brightest = true;
      for (int j = i - kAside; j <= i + kAside; ++j) brightest &= At(j, color) <= At(i, color);
      if (brightest) return {Angle_deg(i), At(i, color)};
    }
    return {};
  }

  std::vector<float> row_;

 private:
  double half_width_deg_ = 60.0;
  inline static std::unique_ptr<gl::Context> context_;
};

// Returns Descartes' angle from the antisolar point after `reflections` in a drop: Bohren and
// Huffman 1983, section 7.2. The primary bow is at 42.4 degrees for red and 40.6 for violet; the
// secondary is at 50.4 and 53.6.
double BowAngle_deg(double index, int reflections) {
  const double p = reflections + 1.0;
  const double incidence = std::acos(std::sqrt((index * index - 1.0) / (p * p - 1.0)));
  const double refracted = std::asin(std::sin(incidence) / index);
  const double deviation =
      reflections * 180.0 + glm::degrees(2.0 * incidence - 2.0 * p * refracted);
  return std::abs(deviation - 180.0);
}

TEST_F(SkyOptics, RainHasTwoBowsAndADarkBandBetween) {
  Draw({.radius_m = 5e-4, .opposite = true});
  double before_deg = 90.0;
  double secondary_before_deg = 0.0;
  for (int color = kRed; color <= kBlue; ++color) {
    const double index =
        physics::WaterRefractiveIndex(physics::kWavelengthsUm[static_cast<std::size_t>(color)]);
    const Extreme primary = Brightest(color, 38.0, 46.0);
    const Extreme secondary = Brightest(color, 47.0, 57.0);
    // Airy's theory moves the maximum to the bright side by 1.019 (lambda / (2 r))^(2/3) times a
    // factor of order 1. That is 0.4 degrees for such drops.
    EXPECT_NEAR(primary.angle_deg, BowAngle_deg(index, 1) - 0.4, 0.35) << color;
    EXPECT_NEAR(secondary.angle_deg, BowAngle_deg(index, 2) + 0.7, 0.6) << color;
    // Red is the outermost colour of the primary rainbow and the innermost colour of the secondary
    // rainbow.
    EXPECT_LT(primary.angle_deg, before_deg - 0.2);
    EXPECT_GT(secondary.angle_deg, secondary_before_deg + 0.3);
    before_deg = primary.angle_deg;
    secondary_before_deg = secondary.angle_deg;
    const double band = AtAngle(46.5, color);
    EXPECT_LT(band, 0.5 * AtAngle(35.0, color)) << "Alexander's band against the inside";
    EXPECT_LT(band, 0.7 * AtAngle(58.0, color)) << "and against the outside";
    EXPECT_GT(primary.value, 3.0 * secondary.value);
    EXPECT_GT(secondary.value, 2.0 * band);
  }
  EXPECT_NEAR(Brightest(kRed, 38.0, 46.0).angle_deg, 42.0, 0.4);
  EXPECT_NEAR(Brightest(kRed, 47.0, 57.0).angle_deg, 51.0, 0.6);
}

// The first ring's radius is inversely proportional to the drop radius and proportional to the
// wavelength, so red is outside: van de Hulst 1957, section 17.3; Laven 2005 (Applied Optics 44,
// 5667).
TEST_F(SkyOptics, TheGloryIsWiderOfSmallerDropsAndRedOutside) {
  std::array<double, 2> red_deg{};
  for (int i = 0; i < 2; ++i) {
    const double radius_m = i == 0 ? 5e-6 : 1e-5;
    Draw({.radius_m = radius_m, .opposite = true, .half_width_deg = 10.0});
    const Extreme red = FirstRing(kRed);
    const Extreme blue = FirstRing(kBlue);
    EXPECT_NEAR(red.angle_deg / blue.angle_deg, 0.65 / 0.45, 0.15);
    red_deg[static_cast<std::size_t>(i)] = red.angle_deg;
  }
  EXPECT_NEAR(red_deg[0] / red_deg[1], 2.0, 0.2);
}

// Fraunhofer's rings of discs have maxima at sin t = 1.635 and 2.679 lambda / (2 r), and are dark
// at 1.220 (Airy). For drops of a few wavelengths they are up to a tenth nearer to the sun (Cowley,
// Laven and Vollmer 2005, Physics Education 40, 51).
TEST_F(SkyOptics, DropsOfOneSizeHaveACoronaAndOthersAnAureole) {
  Draw({.kind = physics::PhaseKind::kWaterNarrow,
        .radius_m = 5e-6,
        .optical_depth = 0.1,
        .half_width_deg = 15.0});
  double before_deg = 90.0;
  for (int color = kRed; color <= kBlue; ++color) {
    const double step_deg =
        glm::degrees(physics::kWavelengthsUm[static_cast<std::size_t>(color)] / 10.0);
    const Extreme dark = Darkest(color, 0.9 * step_deg, 1.5 * step_deg);
    const Extreme ring = Brightest(color, dark.angle_deg, 2.0 * step_deg);
    EXPECT_NEAR(dark.angle_deg / step_deg, 1.22, 0.12) << color;
    EXPECT_NEAR(ring.angle_deg / step_deg, 1.635, 0.16) << color;
    EXPECT_GT(ring.value, 1.2 * dark.value);
    EXPECT_LT(ring.angle_deg, before_deg - 0.4) << "red is outside";
    before_deg = ring.angle_deg;
  }
  EXPECT_GT(Brightest(kRed, 7.5, 10.5).value, 1.05 * Darkest(kRed, 6.5, 9.0).value)
      << "the second ring";
  // Drops of many sizes make no ring: the radiance falls steadily with the angle.
  Draw({.radius_m = 5e-6, .optical_depth = 0.1, .half_width_deg = 15.0});
  EXPECT_GT(AtAngle(1.0, kRed), 20.0 * AtAngle(6.0, kRed));
  const Extreme dark = Darkest(kRed, 3.0, 6.0);
  EXPECT_GT(dark.angle_deg, 5.8);
}

// Cutting the forward peak must leave no visible edge. Within the cut angle the picture must equal
// that of the whole phase function.
TEST_F(SkyOptics, TheAureoleOfAThinSlabIsItsPhaseFunction) {
  for (const physics::PhaseKind kind :
       {physics::PhaseKind::kWaterDroplets, physics::PhaseKind::kIceColumns}) {
    constexpr double kDepth = 0.02;
    Draw({.kind = kind, .radius_m = 1e-5, .optical_depth = kDepth, .half_width_deg = 15.0});
    const physics::PhaseFunction phase{kind, 0.0F,
                                       kind == physics::PhaseKind::kWaterDroplets ? 1e-5F : 0.0F};
    for (const double angle_deg : {0.6, 1.0, 2.0, 4.0, 7.0, 9.9, 10.1, 12.0}) {
      int i = kPixels / 2;
      while (Angle_deg(i) < angle_deg) ++i;
      for (int color = kRed; color <= kBlue; ++color) {
        const double expected =
            kDepth * std::exp(-kDepth) *
            physics::PhaseColors(phase, std::cos(glm::radians(Angle_deg(i))))[color] /
            (4.0 * std::numbers::pi);
        // Light that is scattered twice has a fiftieth of the radiance of light that is scattered
        // once, and spreads wider.
        EXPECT_NEAR(At(i, color) / expected, 1.0, 0.06) << angle_deg << " " << color;
      }
    }
  }
}

// The table contains all light that the peak scatters more than once: 1 - exp(-d) (1 + d).
TEST(Aureole, HoldsAllThatIsScatteredWithinThePeak) {
  for (const physics::PhaseFunction& phase :
       {physics::PhaseFunction{physics::PhaseKind::kWaterDroplets, 0.0F, 1e-5F},
        physics::PhaseFunction{physics::PhaseKind::kIceRough},
        physics::PhaseFunction{physics::PhaseKind::kHenyeyGreenstein, 0.85F}}) {
    using physics::Aureole;
    const Aureole aureole = Aureole::Of(phase, glm::radians(10.0));
    for (const int d : {8, 12, 16}) {
      const double depth = Aureole::kMaxDepth * std::pow(d / (Aureole::kDepths - 1.0), 2.0);
      double sum = 0.0;
      for (int a = 1; a < Aureole::kAngles; ++a) {
        const auto angle = [&](int i) {
          return aureole.end_rad * std::pow(i / (Aureole::kAngles - 1.0), 2.0);
        };
        const auto value = [&](int i) {
          return glm::dot(
              physics::kLuminance,
              glm::dvec3(aureole.radiances[static_cast<std::size_t>(d * Aureole::kAngles + i)]));
        };
        sum += std::numbers::pi * (value(a) + value(a - 1)) *
               (std::cos(angle(a - 1)) - std::cos(angle(a)));
      }
      const double expected = -std::expm1(-depth) - depth * std::exp(-depth);
      // A part of the light lies beyond the table's largest angle. This part grows with the number
      // of scatterings.
      EXPECT_NEAR(sum / expected, 1.0, 0.05) << depth;
    }
  }
}

// The Earth's shadow reaches up to R (1 / cos d - 1) when the sun is d below the horizon: Minnaert
// 1954, The Nature of Light and Colour in the Open Air, section 192. At 2 degrees an anvil is
// therefore lit while the cloud's base is not.
TEST(Twilight, TheEarthsShadowRisesAsTheSunSinks) {
  const physics::Atmosphere atmosphere(1.5F, 0.15F);
  for (const double depression_deg : {1.0, 2.0, 3.0, 4.0}) {
    const double sun = glm::radians(depression_deg);
    const double radius_of_sun = physics::kSunRadius_rad;
    const auto height = [](double angle_rad) {
      return static_cast<float>(physics::kEarthRadius_m * (1.0 / std::cos(angle_rad) - 1.0));
    };
    const auto sine = static_cast<float>(-std::sin(sun));
    EXPECT_EQ(atmosphere.SunTransmittance({height(sun - 1.1 * radius_of_sun), sine}).r, 0.0F);
    EXPECT_GT(atmosphere.SunTransmittance({height(sun + 0.02), sine}).r, 0.0F) << depression_deg;
  }
}

// Opposite to the sun a blue shadow lies below a belt of reddened light. Both rise as the sun
// sinks, until they fade at 3 to 4 degrees: Lee 2015 (Applied Optics 54, B194).
TEST(Twilight, TheBeltOfVenusStandsAboveTheShadow) {
  const physics::Atmosphere atmosphere(1.5F, 0.15F);
  double before_deg = 0.0;
  for (const double depression_deg : {1.0, 2.0}) {
    const physics::ClearSky sky(atmosphere, glm::vec3(scene::Direction(0.0, -depression_deg)),
                                {0.0F, 0.0F});
    const auto redness = [&](double elevation_deg) {
      const glm::vec3 seen = sky.At(glm::vec3(scene::Direction(180.0, elevation_deg))).radiance;
      return static_cast<double>(seen.r / seen.b);
    };
    double belt_deg = 0.0;
    for (double at = 0.5; at < 30.0; at += 0.25) {
      if (redness(at) > redness(belt_deg)) belt_deg = at;
    }
    EXPECT_GT(belt_deg, before_deg);
    EXPECT_GT(belt_deg, depression_deg);
    EXPECT_LT(belt_deg, 20.0);
    EXPECT_GT(redness(belt_deg), 1.1 * redness(0.5)) << "the shadow is bluer";
    EXPECT_GT(redness(belt_deg), 1.3 * redness(60.0)) << "and so is the sky above";
    before_deg = belt_deg;
  }
}

}  // namespace
}  // namespace thunderhead::renderers
