#include "physics/optics.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "glm/trigonometric.hpp"
#include "gtest/gtest.h"

namespace thunderhead::physics {
namespace {

constexpr PhaseKind kHg = PhaseKind::kHenyeyGreenstein;
constexpr PhaseKind kCs = PhaseKind::kCornetteShanks;

// Returns phase functions of every kind: formulas with several asymmetries, and all tables.
std::vector<PhaseFunction> AllPhases() {
  std::vector<PhaseFunction> phases;
  for (const PhaseKindName& each : kPhaseKindNames) {
    if (const PhaseFormula* const formula = FormulaOf(each.kind); formula != nullptr) {
      for (const float g : {0.0F, 0.85F, -0.5F, 0.979F}) {
        if (formula->has_asymmetry || g == 0.0F) phases.push_back({each.kind, g});
      }
      continue;
    }
    for (const PhaseTableName& table : kPhaseTables) {
      if (table.kind == each.kind) phases.push_back({each.kind, 0.0F, table.droplet_radius_m});
    }
  }
  return phases;
}

// Names the phase function in the message of a failed test.
std::string NameOf(const PhaseFunction& phase) {
  const auto* const name = std::ranges::find(kPhaseKindNames, phase.kind, &PhaseKindName::kind);
  return std::string(name->name) + ", asymmetry " + std::to_string(phase.asymmetry) + ", radius " +
         std::to_string(1e6F * phase.droplet_radius_m) + " um";
}

TEST(PhaseFunctions, TheTestsHaveEveryKind) {
  std::set<PhaseKind> kinds;
  for (const PhaseFunction& phase : AllPhases()) kinds.insert(phase.kind);
  EXPECT_EQ(kinds.size(), kPhaseKindNames.size());
}

TEST(PhaseFunctions, HaveTheMeanOneOverTheSphere) {
  for (const PhaseFunction& phase : AllPhases()) {
    EXPECT_NEAR(CumulativePhase(phase, std::numbers::pi), 1.0, 2e-5) << NameOf(phase);
  }
}

TEST(PhaseFunctions, ASingleValueIsTheLuminanceOfTheColors) {
  for (const PhaseFunction& phase : AllPhases()) {
    for (double angle_deg = 0.3; angle_deg < 180.0; angle_deg += 7.1) {
      const double mu = std::cos(glm::radians(angle_deg));
      const glm::dvec3 colors = PhaseColors(phase, mu);
      EXPECT_NEAR(PhaseValue(phase, mu), 0.2126 * colors.r + 0.7152 * colors.g + 0.0722 * colors.b,
                  1e-12 * colors.g);
    }
  }
}

TEST(PhaseFunctions, IceHasItsHaloAndWaterItsBow) {
  const auto at = [](PhaseKind kind, double angle_deg) {
    return PhaseValue({kind, 0.0F, 1e-5F}, std::cos(glm::radians(angle_deg)));
  };
  for (const PhaseKind kind : {PhaseKind::kIceColumns, PhaseKind::kIcePlates}) {
    EXPECT_GT(at(kind, 22.25), 2.0 * at(kind, 20.0));
    EXPECT_GT(at(kind, 46.25), 1.3 * at(kind, 44.0));
  }
  EXPECT_LT(at(PhaseKind::kIceRough, 22.25), at(PhaseKind::kIceRough, 20.0));
  EXPECT_GT(at(PhaseKind::kWaterDroplets, 140.0), 1.5 * at(PhaseKind::kWaterDroplets, 120.0));
}

TEST(PhaseFunctions, DropletsTakeTheTableOfTheNearestRadius) {
  ParticleOptics optics = DefaultOptics(Hydrometeor::kCloud);
  for (const auto& [radius_m, table_m] :
       {std::pair(1e-7F, 5e-6F), std::pair(7e-6F, 5e-6F), std::pair(7.2e-6F, 1e-5F),
        std::pair(1.4e-5F, 1e-5F), std::pair(1.5e-5F, 2e-5F), std::pair(9e-5F, 2e-5F),
        std::pair(1.1e-4F, 5e-4F), std::pair(1e-3F, 5e-4F), std::pair(0.1F, 5e-4F)}) {
    optics.radius_m = radius_m;
    EXPECT_EQ(PhaseOf(optics).droplet_radius_m, table_m) << radius_m;
  }
  // The expected values are published asymmetries at 0.55 um. The luminance is mostly that of
  // green.
  EXPECT_NEAR(MeanCosine({PhaseKind::kWaterDroplets, 0.0F, 5e-6F}), 0.846, 0.003);
  EXPECT_NEAR(MeanCosine({PhaseKind::kWaterDroplets, 0.0F, 1e-5F}), 0.862, 0.003);
  EXPECT_NEAR(MeanCosine({PhaseKind::kWaterDroplets, 0.0F, 2e-5F}), 0.872, 0.003);
}

TEST(PhaseFunctions, WhatDoesNotMatterDoesNotMakeThemDiffer) {
  ParticleOptics a = DefaultOptics(Hydrometeor::kSnow);
  ParticleOptics b = DefaultOptics(Hydrometeor::kGraupel);
  b.phase.asymmetry = 0.1F;
  EXPECT_EQ(PhaseOf(a), PhaseOf(b));
  a.phase = {PhaseKind::kRayleigh, 0.5F};
  b.phase = {PhaseKind::kRayleigh, 0.2F};
  EXPECT_EQ(PhaseOf(a), PhaseOf(b));
  a.phase = {kHg, 0.5F};
  b.phase = {kHg, 0.2F};
  EXPECT_NE(PhaseOf(a), PhaseOf(b));
  b.phase = {kHg, 0.5F};
  EXPECT_EQ(PhaseOf(a), PhaseOf(b));
  b.phase = {kCs, 0.5F};
  EXPECT_NE(PhaseOf(a), PhaseOf(b));
}

TEST(PhaseFunctions, PlaceInACurveGoesEvenlyFromStraightOnToStraightBack) {
  const auto haversine = [](double angle_deg) {
    return static_cast<float>(std::pow(std::sin(glm::radians(angle_deg) / 2.0), 2.0));
  };
  EXPECT_EQ(glsl::phase_curve_place(0.0F), 0.0F);
  EXPECT_EQ(glsl::phase_curve_place(1.0F), 1.0F);
  EXPECT_EQ(glsl::phase_curve_place(1.0000001F), 1.0F);
  EXPECT_NEAR(glsl::phase_curve_place(haversine(90.0)), std::sqrt(0.5), 1e-6);
  // These angles are so small that their cosine is 1 in single precision.
  EXPECT_NEAR(glsl::phase_curve_place(haversine(1e-3)), std::sqrt(glm::radians(1e-3) / 2.0), 1e-6);
  double before = 0.0;
  for (double angle_deg = 0.1; angle_deg <= 180.0; angle_deg += 0.1) {
    const double place = glsl::phase_curve_place(haversine(angle_deg));
    // A step of a tenth of a degree must span at least one of the curve's 4096 texels. Near the
    // forward direction it may span at most about 120 texels.
    EXPECT_GT(place - before, 1.1 / 4096.0) << angle_deg;
    EXPECT_LT(place - before, 0.03) << angle_deg;
    before = place;
  }
}

TEST(PhaseFunctions, HandComputedValues) {
  // For HG with g = 0.5, the forward value is 0.75 / 0.125 = 6, and the backward value 0.75 / 3.375
  // = 2/9.
  EXPECT_NEAR(PhaseValue({kHg, 0.5F}, 1.0), 6.0, 1e-6);
  EXPECT_NEAR(PhaseValue({kHg, 0.5F}, -1.0), 2.0 / 9.0, 1e-6);
  // For Cornette-Shanks with g = 0.5, the value at 90 degrees is 1.5 * 0.75 / 2.25 / 1.25^1.5 =
  // 0.357771.
  EXPECT_NEAR(PhaseValue({kCs, 0.5F}, 0.0), 0.357771, 1e-5);
  EXPECT_NEAR(PhaseValue({PhaseKind::kRayleigh, 0.0F}, 1.0), 1.5, 1e-6);
}

TEST(PhaseFunctions, MeanCosines) {
  EXPECT_NEAR(MeanCosine({kHg, 0.85F}), 0.85, 1e-5);
  // The formula is Cornette and Shanks 1992, eq. 9: g 3 (4 + g^2) / (5 (2 + g^2)).
  const double g = 0.85;
  EXPECT_NEAR(MeanCosine({kCs, 0.85F}), g * 3 * (4 + g * g) / (5 * (2 + g * g)), 1e-5);
}

TEST(PhaseFunctions, ShareScatteredWithinTenDegrees) {
  // Cornette-Shanks scatters 90 % within ten degrees at g = 0.979, as Riley et al. 2003 (Vis) say
  // of clouds, but only 38 % at g = 0.85.
  EXPECT_NEAR(CumulativePhase({kCs, 0.979F}, glm::radians(10.0)), 0.90, 0.005);
  EXPECT_NEAR(CumulativePhase({kCs, 0.85F}, glm::radians(10.0)), 0.38, 0.005);
}

TEST(DeltaScaling, WhatIsCutAndWhatIsLeftAddUp) {
  for (const PhaseFunction& phase : AllPhases()) {
    const DeltaScaling cut = CutForwardPeak(phase, glm::radians(10.0));
    double left = 0.0;
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) {
      const double mu = -1.0 + 2.0 * (i + 0.5) / kSteps;
      left += PhaseValue(phase, std::fmin(mu, cut.cut_cosine)) / kSteps;
    }
    // The tolerance covers the error of the midpoint rule at the edges of halos.
    EXPECT_NEAR(left + cut.forward_share, 1.0, 1e-4) << NameOf(phase);
    EXPECT_GE(cut.forward_share, 0.0);
  }
  EXPECT_GT(CutForwardPeak({kCs, 0.85F}, glm::radians(10.0)).forward_share, 0.1);
  EXPECT_GT(CutForwardPeak({PhaseKind::kIceColumns}, glm::radians(10.0)).forward_share, 0.6);
}

TEST(LightTransport, MeanTransmittanceHoldsFromTinyToHuge) {
  for (double x = 1e-8; x < 1e9; x *= 3.7) {
    const double exact = -std::expm1(-x) / x;
    // Input and output are in single precision, which leaves a few parts in 1e-6.
    EXPECT_NEAR(glsl::mean_transmittance(static_cast<float>(x)) / exact, 1.0, 5e-6) << x;
  }
  EXPECT_FLOAT_EQ(glsl::mean_transmittance(0.0F), 1.0F);
}

TEST(LightTransport, CounterTransmittanceAgainstQuadrature) {
  for (const auto& [view, light] :
       {std::pair(0.3, 2.0), std::pair(5.0, 0.1), std::pair(1.0, 1.0)}) {
    double mean = 0.0;
    constexpr int kSteps = 10000;
    for (int i = 0; i < kSteps; ++i) {
      const double t = (i + 0.5) / kSteps;
      mean += std::exp(-view * (1.0 - t) - light * t) / kSteps;
    }
    EXPECT_NEAR(
        glsl::mean_counter_transmittance(static_cast<float>(view), static_cast<float>(light)), mean,
        1e-6);
  }
}

TEST(LightTransport, MeanSeenPlaceGoesFromTheMiddleToTheFace) {
  EXPECT_FLOAT_EQ(glsl::mean_seen_place(0.0F), 0.5F);
  EXPECT_NEAR(glsl::mean_seen_place(1.0F), 1.0 - 1.0 / (std::exp(1.0) - 1.0), 1e-6);
  EXPECT_NEAR(glsl::mean_seen_place(1e6F), 1e-6, 1e-9);
  EXPECT_NEAR(glsl::mean_seen_place(0.0999F), glsl::mean_seen_place(0.1001F), 1e-4);
}

TEST(LightTransport, DiffuseLightKeepsItsEnergy) {
  // By Eddington's approximation the net diffuse flux is -(4 pi / 3) dJ/dtau downwards, and the
  // half fluxes are pi J -+ (2 pi / 3) dJ/dtau. The light reflected, transmitted diffusely and
  // transmitted directly must add up to the incoming light.
  for (const double total : {0.01, 0.5, 2.0, 20.0}) {
    const auto intensity = [&](double tau) {
      return static_cast<double>(
          glsl::diffuse_mean_intensity(static_cast<float>(tau), static_cast<float>(total)));
    };
    const double step = std::fmin(total * 1e-2, 1e-2);
    const double slope_top =
        (-3 * intensity(0) + 4 * intensity(step) - intensity(2 * step)) / (2 * step);
    const double slope_bottom =
        (3 * intensity(total) - 4 * intensity(total - step) + intensity(total - 2 * step)) /
        (2 * step);
    const double pi = std::numbers::pi;
    const double reflected = pi * intensity(0) + 2 * pi / 3 * slope_top;
    const double transmitted = pi * intensity(total) - 2 * pi / 3 * slope_bottom;
    // The tolerance covers the derivatives, which are finite differences of single-precision
    // values.
    EXPECT_NEAR(reflected + transmitted + std::exp(-total), 1.0, 2e-3) << total;
  }
}

TEST(LightTransport, DiffuseLightAtTheFaceOfAnInfiniteLayer) {
  EXPECT_NEAR(glsl::diffuse_mean_intensity(0.0F, 1e6F), 1.0 / (2.0 * std::numbers::pi), 1e-5);
  EXPECT_NEAR(glsl::diffuse_mean_intensity(0.0F, 0.0F), 0.0, 1e-7);
}

}  // namespace
}  // namespace thunderhead::physics
