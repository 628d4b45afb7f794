// Tests of the light volume and its ray march against closed forms, and against half-angle slicing,
// which has the same light model.
#include <cmath>
#include <numbers>

#include "gtest/gtest.h"
#include "tests/accuracy/slab_view.h"
#include "tests/support/techniques.h"

namespace thunderhead::renderers {
namespace {

class LightVolume : public SlabView {
 protected:
  void SetUp() override {
    test_support::SetTechnique(&scene_.rendering.technique, test_support::kLightVolume);
  }

  void SingleScattering() {
    test_support::SetMode(&scene_.rendering.technique, test_support::kLowAlbedo);
    test_support::SetTransport(&scene_.rendering.technique, scene::Transport::kConsistent);
    SetPhase(physics::PhaseKind::kCornetteShanks, 0.0F);
  }
};

TEST_F(LightVolume, ReflectedLightOfALayer) {
  // With sun and eye above, the result is the integral of exp(-t (1 / sin e + 1 / sin s)) dt / sin
  // e, for any profile of extinction. The light volume's texels (94 m) are wider than the layer's
  // cells are high (62 m). The remaining error comes from interpolation over a texel, in which a
  // ray's optical depth is up to 20.
  SingleScattering();
  in_air_ = true;
  for (const double depth : {0.01, 0.5, 3.0, 20.0, 100.0}) {
    for (const auto& [view_deg, sun_deg] :
         {std::pair(89.9, 89.9), std::pair(88.0, 45.0), std::pair(50.0, 60.0)}) {
      const double view = 1.0 / std::sin(view_deg * std::numbers::pi / 180);
      const double sun = 1.0 / std::sin(sun_deg * std::numbers::pi / 180);
      const double expected =
          PhaseTerm(view_deg, sun_deg) * view * -std::expm1(-depth * (view + sun)) / (view + sun);
      const Seen seen = Look(depth, view_deg, sun_deg);
      EXPECT_NEAR(seen.radiance / expected, 1.0, 0.05)
          << "depth " << depth << ", view " << view_deg << ", sun " << sun_deg;
      // A ray ends when its transmittance is below 0.005.
      EXPECT_NEAR(seen.transmittance, std::exp(-depth * view), 0.005);
    }
  }
}

TEST_F(LightVolume, HardFaces) {
  // At a face of the domain extinction jumps instead of rising, which the light volume's texels
  // cannot follow. The error grows with the optical depth of one texel (here 0.09 of the slab's).
  SingleScattering();
  for (const double depth : {0.01, 0.5, 3.0}) {
    const double sun = std::numbers::sqrt2;
    const double expected = PhaseTerm(89.9, 45.0) * -std::expm1(-depth * (1.0 + sun)) / (1.0 + sun);
    EXPECT_NEAR(Look(depth, 89.9, 45.0).radiance / expected, 1.0, 0.01 + 0.02 * depth) << depth;
  }
}

TEST_F(LightVolume, TransmittanceDoesNotDependOnTheNumberOfSamples) {
  SingleScattering();
  for (const int samples : {1, 3, 16, 500}) {
    scene::SetSlices(&scene_.rendering.technique, samples);
    EXPECT_NEAR(Look(1.0, 60.0, 45.0).transmittance,
                std::exp(-1.0 / std::sin(std::numbers::pi / 3)), kTextureError)
        << samples;
  }
}

TEST_F(LightVolume, AStepThroughHazeEndsWhereTheCloudBegins) {
  // In a thin brick (block of cells) the ray march samples once per cell, but it must not step over
  // the beginning of a thick brick. The haze is as high as the layer, which is half of the domain.
  SingleScattering();
  in_air_ = true;
  haze_per_m_ = 2e-5;
  scene::SetSlices(&scene_.rendering.technique, 512);
  for (const double depth : {0.5, 2.0}) {
    for (const double elevation_deg : {89.9, 50.0, -25.0, -89.9}) {
      const double through = (depth + haze_per_m_ * kHeight_m / 2) /
                             std::sin(std::abs(elevation_deg) * std::numbers::pi / 180);
      EXPECT_NEAR(Look(depth, elevation_deg, 45.0).transmittance, std::exp(-through), kTextureError)
          << "depth " << depth << ", view " << elevation_deg;
    }
  }
}

TEST_F(LightVolume, ThinSlabsKeepTheirDigits) {
  SingleScattering();
  scene::SetSlices(&scene_.rendering.technique, 1024);
  for (const double depth : {3e-4, 1e-2}) {
    const double expected = PhaseTerm(89.9, 89.9) * depth;
    EXPECT_NEAR(Look(depth, 89.9, 89.9).radiance / expected, 1.0, 0.006 + depth);
  }
}

TEST_F(LightVolume, AlbedoScalesSingleScattering) {
  SingleScattering();
  const double white = Look(1.0, 80.0, 60.0).radiance;
  for (scene::FieldParameters& field : scene_.fields) field.optics.albedo = 0.5F;
  EXPECT_NEAR(Look(1.0, 80.0, 60.0).radiance / white, 0.5, kTextureError);
}

TEST_F(LightVolume, AgreesWithHalfAngleSlicing) {
  in_air_ = true;
  SetPhase(physics::PhaseKind::kCornetteShanks, 0.85F);
  for (const auto mode : {test_support::kUniformPhase, test_support::kPerFieldPhase}) {
    test_support::SetMode(&scene_.rendering.technique, mode);
    for (const double depth : {0.1, 1.0, 10.0, 100.0}) {
      for (const double elevation_deg : {-60.0, 30.0, 80.0}) {
        test_support::SetTechnique(&scene_.rendering.technique, test_support::kHalfAngle);
        scene::SetSlices(&scene_.rendering.technique, 512);
        const double slices = Look(depth, elevation_deg, 50.0).radiance;
        test_support::SetTechnique(&scene_.rendering.technique, test_support::kLightVolume);
        scene::SetSlices(&scene_.rendering.technique, 128);
        const double volume = Look(depth, elevation_deg, 50.0).radiance;
        // Diffuse light is interpolated linearly from cell to cell here. Where a cell's optical
        // depth is 12, the error shows most on the dark side.
        EXPECT_NEAR(volume / slices, 1.0, depth > 10.0 ? 0.25 : 0.05)
            << depth << ", from " << elevation_deg;
      }
    }
  }
}

TEST_F(LightVolume, PaperTransportDependsOnTheNumberOfSlicesAsPrinted) {
  // Seen from below, the slab transmits less light with more slices: half_angle_test.cc,
  // PaperTransportIsAsPrinted, has the formula.
  test_support::SetMode(&scene_.rendering.technique, test_support::kUniformPhase);
  test_support::SetTransport(&scene_.rendering.technique, scene::Transport::kPaper);
  const auto seen = [&](int slices, const accuracy::PlainTechnique& renderer) {
    scene::SetSlices(&scene_.rendering.technique, slices);
    test_support::SetTechnique(&scene_.rendering.technique, renderer);
    return Look(10.0, -89.9, 89.9).radiance;
  };
  const double coarse = seen(16, test_support::kLightVolume);
  const double fine = seen(128, test_support::kLightVolume);
  EXPECT_GT(coarse, 1.05 * fine);
  const double slicing = seen(16, test_support::kHalfAngle) / seen(128, test_support::kHalfAngle);
  // The light volume counts a slice's own attenuation of the light at the middle of the slice.
  // Half-angle slicing counts it before the slice.
  EXPECT_NEAR(coarse / fine / slicing, 1.0, 0.05);
}

TEST_F(LightVolume, ThickSlabIsWhite) {
  // The bounds are those of half-angle slicing's test, for the same reasons.
  test_support::SetMode(&scene_.rendering.technique, test_support::kPerFieldPhase);
  const double radiance = Look(5000.0, 89.0, 89.0).radiance;
  EXPECT_GT(radiance, 0.7 / std::numbers::pi);
  EXPECT_LT(radiance, 1.3 / std::numbers::pi);
}

class MarchedDepths : public LightVolume, public testing::WithParamInterface<double> {};

TEST_P(MarchedDepths, NothingBreaks) {
  for (const auto mode : {test_support::kLowAlbedo, test_support::kPerFieldPhase}) {
    for (const auto transport :
         {scene::Transport::kPaper, scene::Transport::kConsistent, scene::Transport::kDiffusion}) {
      for (const double elevation_deg : {-80.0, 30.0, 89.0}) {
        test_support::SetMode(&scene_.rendering.technique, mode);
        test_support::SetTransport(&scene_.rendering.technique, transport);
        scene::SetSlices(&scene_.rendering.technique, 8);
        const Seen seen = Look(GetParam() * 8, elevation_deg, 40.0);
        // Half floats cannot represent 1 minus a depth below 5e-4, nor radiances below 6e-8.
        if (GetParam() * 8 > 5e-4) {
          EXPECT_LT(seen.transmittance, 1.0);
          // At a hard face no light reaches the middle of thick cells.
          if (GetParam() < 10.0 && elevation_deg > 0.0) {
            EXPECT_GT(seen.radiance, 0.0) << elevation_deg;
          }
        }
        for (std::size_t i = 0; i < seen.eye.size(); ++i) {
          ASSERT_TRUE(std::isfinite(seen.eye[i]));
          ASSERT_GE(seen.eye[i], 0.0F);
        }
        EXPECT_LE(seen.transmittance, 1.0);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(PerSegment, MarchedDepths, testing::Values(1e-8, 1e-4, 1.0, 1e4, 1e8));

}  // namespace
}  // namespace thunderhead::renderers
