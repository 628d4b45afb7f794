// Tests of the clear sky and of the air between the camera and the storm. The sky is compared with
// conservation of energy, plane-parallel limits and observations, and the air with its numerical
// integral.
#include "physics/sky.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "glm/common.hpp"
#include "glm/trigonometric.hpp"
#include "gtest/gtest.h"

namespace thunderhead::physics {
namespace {

glm::vec3 TowardsSun(float elevation_deg) {
  const float elevation = glm::radians(elevation_deg);
  return {std::cos(elevation), 0.0F, std::sin(elevation)};
}

TEST(ClearSky, SunlightAndSkylightShareWhatCameIn) {
  for (const float turbidity : {1.0F, 1.5F, 4.0F, 10.0F}) {
    const Atmosphere atmosphere(turbidity, 0.0F);
    for (const float elevation_deg : {5.0F, 20.0F, 45.0F, 80.0F}) {
      const ClearSky sky(atmosphere, TowardsSun(elevation_deg), {.eye_m = 0.0F});
      const float sine = std::sin(glm::radians(elevation_deg));
      const glm::vec3 direct = sine * sky.SunTransmittance();
      for (int channel = 0; channel < 3; ++channel) {
        EXPECT_GT(sky.Light().irradiance[channel], 0.0F);
        // A low sun also lights the air of a round Earth from the side, so sunlight and skylight
        // together may exceed the sun's irradiance on level ground.
        if (elevation_deg >= 20.0F) {
          EXPECT_LE(direct[channel] + sky.Light().irradiance[channel], sine) << elevation_deg;
        }
      }
      if (turbidity < 3.0F && elevation_deg >= 20.0F) {
        EXPECT_GT(sky.Light().mean_radiance.b, sky.Light().mean_radiance.r);
      }
    }
  }
}

TEST(ClearSky, TurnsWithTheSun) {
  const Atmosphere atmosphere(2.5F, 0.2F);
  const glm::vec3 elsewhere(0.6F * std::cos(0.5F), -0.8F * std::cos(0.5F), std::sin(0.5F));
  ClearSky made(atmosphere, elsewhere, {.eye_m = 500.0F});
  made.TurnTo({std::cos(0.5F), 0.0F, std::sin(0.5F)});
  const ClearSky there(atmosphere, {std::cos(0.5F), 0.0F, std::sin(0.5F)}, {.eye_m = 500.0F});
  for (const float azimuth : {0.0F, 1.0F, 3.0F, 5.0F}) {
    for (const float sine : {-0.2F, 0.1F, 0.7F}) {
      const float level = std::sqrt(1.0F - sine * sine);
      const glm::vec3 direction(level * std::cos(azimuth), level * std::sin(azimuth), sine);
      for (int channel = 0; channel < 3; ++channel) {
        const float expected = there.At(direction).radiance[channel];
        EXPECT_NEAR(made.At(direction).radiance[channel] / expected, 1.0F, 2e-3F)
            << azimuth << " " << sine;
      }
    }
  }
}

TEST(ClearSky, AirAloneScattersHalfOfWhatItTakesDown) {
  // Without haze, half of the light that thin air scatters comes down, because Rayleigh's phase
  // function is symmetric. A second scattering sends half of the upward light down again. Skylight
  // is therefore a little more than half of the direct beam's loss; ozone absorbs 2 %.
  const Atmosphere atmosphere(1.0F, 0.0F);
  for (const float elevation_deg : {40.0F, 60.0F, 90.0F}) {
    const ClearSky sky(atmosphere, TowardsSun(elevation_deg), {.eye_m = 0.0F});
    const float sine = std::sin(glm::radians(elevation_deg));
    const glm::vec3 lost = sine * (glm::vec3(1.0F) - glm::exp(-glsl::air_optical_depth() / sine));
    const glm::vec3 share = sky.Light().irradiance / lost;
    for (int channel = 0; channel < 3; ++channel) {
      EXPECT_GT(share[channel], 0.46F) << elevation_deg;
      EXPECT_LT(share[channel], 0.58F) << elevation_deg;
    }
  }
}

TEST(ClearSky, DirectSunlightIsThatOfThePlaneParallelAir) {
  // Expects Bouguer's law with the air mass of Kasten and Young 1989: 1.994 at 30 degrees, 5.60 at
  // 10. Haze lies lower than air and ozone higher, so the tolerance is 3 % of the depth.
  const Atmosphere atmosphere(2.0F, 0.2F);
  const glm::vec3 ozone(0.020F, 0.027F, 0.0014F);
  const glm::vec3 depth = glsl::air_optical_depth() + glsl::haze_optical_depth(2.0F) + ozone;
  for (const auto& [elevation_deg, mass] :
       {std::pair(90.0F, 1.0F), std::pair(30.0F, 1.994F), std::pair(10.0F, 5.60F)}) {
    const glm::vec3 transmittance =
        ClearSky(atmosphere, TowardsSun(elevation_deg), {.eye_m = 0.0F}).SunTransmittance();
    for (int channel = 0; channel < 3; ++channel) {
      EXPECT_NEAR(-std::log(transmittance[channel]) / (depth[channel] * mass), 1.0, 0.03)
          << elevation_deg << ' ' << channel;
    }
  }
  // For air alone and the sun 0.34 degrees up there are 33.2 air masses; our atmosphere is
  // isothermal.
  const Atmosphere clean(1.0F, 0.2F);
  const float at_horizon = -std::log(clean.SunTransmittance({0.0F, 0.006F}).b);
  EXPECT_NEAR(at_horizon / glsl::air_optical_depth().b, 33.2, 2.5);
}

TEST(ClearSky, DarkensThroughTwilightToBlack) {
  const Atmosphere atmosphere(1.5F, 0.2F);
  float before = 1e9F;
  for (float elevation_deg = 90.0F; elevation_deg >= -40.0F; elevation_deg -= 2.0F) {
    const ClearSky sky(atmosphere, TowardsSun(elevation_deg), {.eye_m = 0.0F});
    const float irradiance = sky.Light().irradiance.g;
    ASSERT_TRUE(std::isfinite(irradiance)) << elevation_deg;
    if (elevation_deg <= 40.0F) {
      EXPECT_LE(irradiance, before) << elevation_deg;
    }
    before = irradiance;
    if (elevation_deg < -1.0F) {
      EXPECT_EQ(sky.SunTransmittance(), glm::vec3(0.0F));
    }
    if (elevation_deg <= -30.0F) {
      EXPECT_EQ(sky.Light().irradiance, glm::vec3(0.0F));
    }
  }
  // At sunset the ground gets some hundredths of a noon sky's light, and at the end of civil
  // twilight (-6 degrees) some thousandths: 400 and 3 lux against 12 000.
  const float noon = ClearSky(atmosphere, TowardsSun(60.0F), {.eye_m = 0.0F}).Light().irradiance.g;
  EXPECT_NEAR(
      std::log10(ClearSky(atmosphere, TowardsSun(0.0F), {.eye_m = 0.0F}).Light().irradiance.g /
                 noon),
      -1.5, 0.4);
  EXPECT_NEAR(
      std::log10(ClearSky(atmosphere, TowardsSun(-6.0F), {.eye_m = 0.0F}).Light().irradiance.g /
                 noon),
      -3.6, 0.7);
}

TEST(ClearSky, RedNearTheSettingSunBlueAbove) {
  const Atmosphere atmosphere(2.0F, 0.2F);
  const ClearSky sky(atmosphere, TowardsSun(2.0F), {.eye_m = 0.0F});
  const glm::vec3 sunwards = sky.At(TowardsSun(2.0F)).radiance;
  const glm::vec3 zenith = sky.At({0.0F, 0.0F, 1.0F}).radiance;
  EXPECT_GT(sunwards.r / sunwards.b, 1.5F);
  EXPECT_LT(zenith.r / zenith.b, 1.0F);
  EXPECT_GT(sunwards.g, 10.0F * zenith.g);
}

glm::vec3 Towards(float azimuth_deg, float elevation_deg) {
  const float azimuth = glm::radians(azimuth_deg);
  const float elevation = glm::radians(elevation_deg);
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
          std::sin(elevation)};
}

// Searches for seams along a line through the sky, in steps so short that the radiance changes
// evenly. A change may be at most 1.5 times that of the previous or next step, plus half a percent.
// A steep change is not a seam: seen from high up, the red of twilight rises by 5 % in a hundredth
// of a degree.
class SeamFinder {
 public:
  // Returns the largest change beyond the permitted change, as a fraction of the radiance.
  float Worst() const { return worst_; }

  void Add(const glm::vec3& radiance) {
    for (int color = 0; color < 3; ++color) {
      ASSERT_TRUE(std::isfinite(radiance[color]) && radiance[color] > 0.0F) << color;
    }
    seen_[0] = seen_[1];
    seen_[1] = seen_[2];
    seen_[2] = seen_[3];
    seen_[3] = radiance;
    if (++count_ < 4) return;
    for (int color = 0; color < 3; ++color) {
      const auto change = [&](std::size_t i) {
        return std::abs(seen_[i + 1][color] / seen_[i][color] - 1.0F);
      };
      worst_ = std::max(worst_, change(1) - 1.5F * std::max(change(0), change(2)) - 0.005F);
    }
  }

  // Starts again, because the next samples lie beyond an edge.
  void Lift() { count_ = 0; }

 private:
  std::array<glm::vec3, 4> seen_{};
  int count_ = 0;
  float worst_ = 0.0F;
};

constexpr float kSeamStep_deg = 0.01F;

void ExpectNoSeamUpwards(const ClearSky& sky, float azimuth_deg, float lowest_deg,
                         float horizon_deg) {
  SeamFinder finder;
  const int steps = static_cast<int>((90.0F - lowest_deg) / kSeamStep_deg);
  for (int i = 0; i < steps; ++i) {
    const float elevation_deg = lowest_deg + static_cast<float>(i) * kSeamStep_deg;
    // The horizon is an edge, because the ground ends the air below it. Next to it the slope of the
    // table's root is unbounded.
    if (std::abs(elevation_deg - horizon_deg) < 0.03F) {
      finder.Lift();
      continue;
    }
    finder.Add(sky.At(Towards(azimuth_deg, elevation_deg)).radiance);
  }
  EXPECT_EQ(finder.Worst(), 0.0F) << "upwards at azimuth " << azimuth_deg;
}

void ExpectNoSeamAround(const ClearSky& sky, float elevation_deg) {
  SeamFinder finder;
  for (int i = -5; i < static_cast<int>(360.0F / kSeamStep_deg) + 5; ++i) {
    const float azimuth_deg = static_cast<float>(i) * kSeamStep_deg;
    finder.Add(sky.At(Towards(azimuth_deg, elevation_deg)).radiance);
  }
  EXPECT_EQ(finder.Worst(), 0.0F) << "around at elevation " << elevation_deg;
}

TEST(ClearSky, HasNoSeams) {
  const Atmosphere atmosphere(1.5F, 0.2F);
  for (const float eye_m : {0.0F, 300.0F, 3000.0F, 15000.0F}) {
    const float horizon_deg = glm::degrees(std::asin(HorizonSine(eye_m)));
    // An eye on the ground has no air below the horizon.
    const float lowest_deg = eye_m == 0.0F ? 0.05F : -89.9F;
    for (const float sun_deg : {-8.0F, 0.0F, 5.0F, 30.0F, 90.0F}) {
      SCOPED_TRACE(testing::Message() << "from " << eye_m << " m, sun at " << sun_deg);
      const ClearSky sky(atmosphere, TowardsSun(sun_deg), {.eye_m = eye_m});
      for (float azimuth_deg = 0.0F; azimuth_deg < 360.0F; azimuth_deg += 40.0F) {
        ExpectNoSeamUpwards(sky, azimuth_deg, lowest_deg, horizon_deg);
      }
      for (const float elevation_deg : {-60.0F, -8.0F, -4.0F, 0.1F, 3.0F, 20.0F, 60.0F}) {
        if (elevation_deg >= lowest_deg) ExpectNoSeamAround(sky, elevation_deg);
      }
    }
  }
}

// Compares the sky table with the integral along rays, in directions between the table's nodes.
TEST(ClearSky, TableHoldsTheIntegral) {
  const Atmosphere atmosphere(1.5F, 0.2F);
  for (const float sun_deg : {-8.0F, 0.0F, 5.0F, 30.0F, 90.0F}) {
    for (const float height_m : {0.0F, 3000.0F}) {
      const ClearSky sky(atmosphere, TowardsSun(sun_deg), {.eye_m = height_m});
      glm::vec3 worst(0.0F);
      float worst_air_mass = 0.0F;
      for (float azimuth_deg = 0.0F; azimuth_deg <= 180.0F; azimuth_deg += 7.0F) {
        for (float elevation_deg = 0.03F; elevation_deg < 90.0F; elevation_deg *= 1.13F) {
          const glm::vec3 direction = Towards(azimuth_deg, elevation_deg);
          const glm::vec3 towards_sun = TowardsSun(sun_deg);
          const float mu = glm::dot(direction, towards_sun);
          const Atmosphere::Line line =
              atmosphere.Along({.height_m = height_m, .sine = direction.z, .steps = 400});
          const Atmosphere::Gathered gathered = atmosphere.Gather(line, {towards_sun.z, mu});
          const glm::vec3 expected = gathered.air * (0.75F * (1.0F + mu * mu) * 0.0795775F) +
                                     gathered.diffuse + gathered.haze * glsl::haze_phase(mu);
          const ClearSky::Seen seen = sky.At(direction);
          worst = glm::max(worst, glm::abs(seen.radiance / expected - 1.0F));
          worst_air_mass =
              std::max(worst_air_mass, std::abs(seen.air_mass.x / line.air_mass.x - 1.0F));
        }
      }
      // The table is linear between nodes, while the light is nearly exponential in elevation. The
      // error is largest in twilight, and there in red.
      const glm::vec3 most = sun_deg < 0.0F ? glm::vec3(0.11F, 0.10F, 0.10F) : glm::vec3(0.04F);
      EXPECT_LT(worst.r, most.r) << sun_deg << ' ' << height_m;
      EXPECT_LT(worst.g, most.g) << sun_deg << ' ' << height_m;
      EXPECT_LT(worst.b, most.b) << sun_deg << ' ' << height_m;
      EXPECT_LT(worst_air_mass, 0.01F) << sun_deg << ' ' << height_m;
    }
  }
}

TEST(ClearSky, FromAboveTheAirIsBlueAndTheSkyBlack) {
  const Atmosphere atmosphere(1.5F, 0.2F);
  const ClearSky ground(atmosphere, TowardsSun(50.0F), {.eye_m = 0.0F});
  const ClearSky above(atmosphere, TowardsSun(50.0F), {.eye_m = 1e5F});
  const glm::vec3 up(0.0F, 0.0F, 1.0F);
  EXPECT_LT(above.At(up).radiance.g, 0.01F * ground.At(up).radiance.g);
  // Seen from above, the air is about as bright as from below.
  const glm::vec3 down = above.At(-up).radiance;
  EXPECT_GT(down.b, 2.0F * down.r);
  EXPECT_NEAR(down.b / ground.At(up).radiance.b, 1.0F, 0.35F);
  EXPECT_LT(ground.At(-up).radiance.g, 1e-4F) << "nothing lies between the eye and the ground";
  // The horizon dips by arccos(R / (R + h)).
  EXPECT_NEAR(HorizonSine(1e4F), -std::sqrt(2.0F * 1e4F / (kEarthRadius_m + 1e4F)), 1e-4F);
}

TEST(Air, DepthIsTheIntegralOfItsDensity) {
  const float curvature = 1.0F / kEarthRadius_m;
  for (const glsl::AirPath& path :
       {glsl::AirPath{2.0F, 0.0F, 0.0F, 1e5F}, glsl::AirPath{2.0F, 0.1F, 0.0F, 8e4F},
        glsl::AirPath{9000.0F, -0.1F, 0.0F, 8e4F}, glsl::AirPath{500.0F, 1.0F, curvature, 5e4F},
        glsl::AirPath{1e5F, -1.0F, curvature, 1e5F}, glsl::AirPath{300.0F, 1e-6F, curvature, 3e5F},
        glsl::AirPath{100.0F, 0.02F, curvature, 300.0F}, glsl::AirPath{2.0F, 0.0F, curvature, 5e5F},
        // The following paths lead from high above the ground down to the ground, past the ground,
        // and down to a lowest point and up again.
        glsl::AirPath{7000.0F, -0.05F, curvature, 1.6e5F},
        glsl::AirPath{7000.0F, -0.035F, curvature, 5e5F},
        glsl::AirPath{2000.0F, -0.01F, curvature, 3e5F},
        // This path leads from space, where there is no haze, to the lowest point and beyond.
        glsl::AirPath{2e5F, -0.222F, curvature, 2.2e6F}}) {
    double sums_m[2] = {0.0, 0.0};
    constexpr int kSteps = 200000;
    const double bend = path.curvature_per_m * (1.0 - path.sin_elevation * path.sin_elevation);
    for (int i = 0; i < kSteps; ++i) {
      const double at_m = path.distance_m * (i + 0.5) / kSteps;
      const double h = path.height_m + path.sin_elevation * at_m + 0.5 * bend * at_m * at_m;
      sums_m[0] += std::exp(-h / glsl::kAirScaleHeight_m) * path.distance_m / kSteps;
      sums_m[1] += std::exp(-h / glsl::kHazeScaleHeight_m) * path.distance_m / kSteps;
    }
    const glm::vec2 densities = glsl::densities_of_air(path.height_m);
    // On short paths the error of the slope of scaled_erfc matters, which is larger than the error
    // of its value.
    EXPECT_NEAR(glsl::equivalent_m(glsl::kAirScaleHeight_m, densities.x, path) / sums_m[0], 1.0,
                0.01)
        << path.height_m << ' ' << path.sin_elevation;
    EXPECT_NEAR(glsl::equivalent_m(glsl::kHazeScaleHeight_m, densities.y, path) / sums_m[1], 1.0,
                0.01)
        << path.height_m << ' ' << path.sin_elevation;
  }
}

TEST(Air, ScaledErrorFunction) {
  for (double x = 0.0; x < 5.0; x += 0.01) {
    EXPECT_NEAR(glsl::scaled_erfc(static_cast<float>(x)) / (std::exp(x * x) * std::erfc(x)), 1.0,
                0.016)
        << x;
  }
}

TEST(Air, FarAwayEverythingIsTheSky) {
  const glm::vec3 sky(0.1F, 0.2F, 0.3F);
  const glm::vec3 cloud(0.5F, 0.6F, 0.7F);
  const glm::vec2 densities = glsl::densities_of_air(2.0F);
  const auto seen = [&](float opacity, float distance_m, float sine) {
    const glm::vec3 transmittance =
        glm::exp(-glsl::depth_of_air(2.0F, densities, {2.0F, sine, 0.0F, distance_m}));
    return opacity *
           (transmittance * cloud +
            glsl::airlight_before(transmittance, sky,
                                  glsl::depth_of_air(2.0F, densities, {2.0F, sine, 0.0F, 5e5F})));
  };
  for (int channel = 0; channel < 3; ++channel) {
    EXPECT_NEAR(seen(1.0F, 0.0F, 0.1F)[channel], cloud[channel], 1e-6);
    EXPECT_NEAR(seen(1.0F, 5e5F, 0.0F)[channel], sky[channel], 0.01);
    EXPECT_NEAR(seen(0.25F, 5e5F, 0.0F)[channel], 0.25 * sky[channel], 0.01);
    // In between, the radiance approaches the sky's with distance.
    EXPECT_LT(seen(1.0F, 5e4F, 0.1F)[channel], cloud[channel]);
    EXPECT_GT(seen(1.0F, 5e4F, 0.1F)[channel], seen(1.0F, 1e5F, 0.1F)[channel]);
    EXPECT_EQ(seen(0.0F, 5e4F, 0.1F)[channel], 0.0F);
  }
}

}  // namespace
}  // namespace thunderhead::physics
