#include "physics/water.h"

#include <cmath>
#include <numbers>

#include "gtest/gtest.h"
#include "physics/counter_random.h"
#include "physics/fresnel.h"

namespace thunderhead::physics {
namespace {

using glm::vec3;

vec3 TowardsFrom(double elevation_deg, double azimuth_deg = 0.0) {
  const double elevation = elevation_deg * std::numbers::pi / 180.0;
  const double azimuth = azimuth_deg * std::numbers::pi / 180.0;
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
          std::sin(elevation)};
}

// Schlick's form is off by up to 0.021, at cosines near 0.1 (where a facet reflects half).
TEST(Water, FacetsReflectByFresnel) {
  for (int i = 0; i <= 20; ++i) {
    const double cosine = 0.05 * i;
    EXPECT_NEAR(glsl::facet_reflectance(static_cast<float>(cosine)),
                i == 0 ? 1.0 : Reflectance(cosine, 1.0 / 1.33), 0.06)
        << cosine;
  }
  EXPECT_NEAR(glsl::facet_reflectance(1.0F), 0.02F, 1e-6F);
}

// Returns the mean reflectance over facets that an eye sees, from sampled slopes.
double SampledReflectance(const vec3& towards_eye) {
  CounterRandom random(1, 9);
  double reflected = 0.0;
  double seen = 0.0;
  for (int i = 0; i < 100'000; ++i) {
    const double slope = std::sqrt(-glsl::kWaterSlopes * std::log(1.0 - random.Next()));
    const double azimuth = 2.0 * std::numbers::pi * random.Next();
    const vec3 facet =
        glm::normalize(vec3(slope * std::cos(azimuth), slope * std::sin(azimuth), 1.0));
    const float facing = glm::dot(facet, towards_eye);
    if (facing <= 0.0F) continue;
    const double weight = facing / facet.z;
    seen += weight;
    reflected += weight * glsl::facet_reflectance(facing);
  }
  return reflected / seen;
}

// Compares with Bruneton's fit, which neglects at low elevations that facets hide each other.
TEST(Water, MeanReflectanceIsThatOfItsFacets) {
  for (const double elevation_deg : {5.0, 10.0, 20.0, 40.0, 90.0}) {
    const vec3 towards_eye = TowardsFrom(elevation_deg);
    EXPECT_NEAR(glsl::water_reflectance(towards_eye.z), SampledReflectance(towards_eye), 0.06)
        << elevation_deg;
  }
  EXPECT_GT(glsl::water_reflectance(TowardsFrom(3.0).z), 0.3F);
  EXPECT_LT(glsl::water_reflectance(1.0F), 0.03F);
}

TEST(Water, GlintIsBrightestNearTheMirroredSun) {
  const vec3 sun = TowardsFrom(40.0, 180.0);
  const float mirrored = glsl::glint(TowardsFrom(40.0, 0.0), sun);
  EXPECT_GT(mirrored, 20.0F * glsl::glint(TowardsFrom(40.0, 90.0), sun));
  EXPECT_GT(mirrored, 20.0F * glsl::glint(TowardsFrom(40.0, 180.0), sun));
  EXPECT_EQ(glsl::glint(TowardsFrom(40.0), TowardsFrom(-1.0)), 0.0F);
  EXPECT_TRUE(std::isfinite(glsl::glint(TowardsFrom(0.01), TowardsFrom(0.01, 180.0))));
}

// Over all directions the glint is the reflectance of water for the sun's irradiance on level
// ground.
TEST(Water, GlintHoldsTheSunlightThatFacetsReflect) {
  for (const double elevation_deg : {30.0, 45.0, 80.0}) {
    const vec3 sun = TowardsFrom(elevation_deg, 180.0);
    double flux = 0.0;
    constexpr int kRows = 400;
    for (int i = 0; i < kRows; ++i) {
      const double sine = (i + 0.5) / kRows;
      for (int j = 0; j < kRows; ++j) {
        const double azimuth_deg = 360.0 * (j + 0.5) / kRows;
        const vec3 out = TowardsFrom(std::asin(sine) * 180.0 / std::numbers::pi, azimuth_deg);
        flux += glsl::glint(out, sun) * sine * 2.0 * std::numbers::pi / (kRows * kRows);
      }
    }
    const double received = sun.z;
    // The model of facets that hide each other loses light that is reflected twice: a seventh of
    // the light at an elevation of 20 degrees.
    EXPECT_NEAR(flux / received, SampledReflectance(sun), 0.1 * SampledReflectance(sun))
        << elevation_deg;
  }
}

}  // namespace
}  // namespace thunderhead::physics
