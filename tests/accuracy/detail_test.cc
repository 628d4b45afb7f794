// Turbulent detail as every renderer draws it, against the noise evaluated on the CPU.
#include <cmath>
#include <numbers>

#include "gtest/gtest.h"
#include "physics/turbulence.h"
#include "tests/accuracy/slab_view.h"
#include "tests/support/techniques.h"

namespace thunderhead::renderers {
namespace {

class DetailInSlab : public SlabView, public testing::WithParamInterface<accuracy::Path> {
 protected:
  void SetUp() override {
    test_support::SetPath(&scene_.rendering.technique, GetParam());
    test_support::SetMode(&scene_.rendering.technique, test_support::kWithDetail);
    test_support::SetTransport(&scene_.rendering.technique,
                               scene::Transport::kPaper);  // unscaled extinction towards the eye
    scene::SetSlices(&scene_.rendering.technique, 512);
  }

  // The mean noise along the middle ray, by the midpoint rule.
  static double MeanNoise(const scene::Detail& detail, double elevation_deg) {
    const physics::TurbulenceTile tile = physics::MakeTurbulence(detail.octaves, detail.seed);
    const double tile_m = detail.wavelength_m * double{physics::TurbulenceTile::kWaves};
    const glm::dvec3 direction = scene::Direction(kViewAzimuth_deg, elevation_deg);
    const double half_m = kHeight_m / 2 / direction.z;
    constexpr int kPoints = 4000;
    double sum = 0.0;
    for (int i = 0; i < kPoints; ++i) {
      const double way_m = ((i + 0.5) / kPoints * 2.0 - 1.0) * half_m;
      const glm::dvec3 world_m = glm::dvec3(0.0, 0.0, kHeight_m / 2) + way_m * direction;
      sum += physics::TurbulenceAt(tile, world_m / tile_m);
    }
    return sum / kPoints;
  }
};

TEST_P(DetailInSlab, IsAtRestInTheWorld) {
  // In every view the optical depth is that of the noise at the ray's points in world coordinates.
  for (const float share : {1.0F, 0.3F}) {
    for (const double elevation_deg : {89.9, 60.0, 45.0}) {
      const scene::Detail detail{.share = share, .wavelength_m = 700.0F, .octaves = 2, .seed = 5};
      scene_.fields[0].detail = detail;
      const double path = 1.0 / std::sin(elevation_deg * std::numbers::pi / 180);
      const double seen = -std::log(Look(1.0, elevation_deg, 80.0).transmittance) / path;
      // The middle pixel is 0.2 degrees wide, 20 m of the wavelength's 700; half-angle slices count
      // whole at the slab's faces; and llvmpipe interpolates 8-bit textures with 8 bits, 0.4 % of a
      // root whose square is 10 at most. From view to view the noise is 0.07, 1.0 and 2.3.
      EXPECT_NEAR(seen, 1.0 + share * (MeanNoise(detail, elevation_deg) - 1.0), 0.03)
          << share << " " << elevation_deg;
    }
  }
}

TEST_P(DetailInSlab, OtherModesDoNotHaveIt) {
  test_support::SetMode(&scene_.rendering.technique, test_support::kPerFieldPhase);
  scene_.fields[0].detail = {.share = 1.0F, .wavelength_m = 700.0F, .octaves = 2, .seed = 5};
  EXPECT_NEAR(-std::log(Look(1.0, 89.9, 80.0).transmittance), 1.0, 0.01);
}

INSTANTIATE_TEST_SUITE_P(Renderers, DetailInSlab,
                         testing::Values(test_support::kHalfAngle, test_support::kLightVolume),
                         [](const auto& renderer) {
                           return renderer.param == test_support::kHalfAngle ? "HalfAngle"
                                                                             : "LightVolume";
                         });

}  // namespace
}  // namespace thunderhead::renderers
