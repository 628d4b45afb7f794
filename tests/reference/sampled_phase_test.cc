#include "reference/sampled_phase.h"

#include <cmath>
#include <numbers>

#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "gtest/gtest.h"
#include "physics/optics.h"

namespace thunderhead::reference {
namespace {

using physics::PhaseFunction;
using physics::PhaseKind;

// Returns the mean of f over samples at evenly spread u. This is a midpoint rule without noise.
template <typename F>
double MeanOverSamples(const SampledPhase& phase, const F& f, std::size_t color = 0) {
  constexpr int kSamples = 200000;
  double sum = 0.0;
  for (int i = 0; i < kSamples; ++i) sum += f(phase.Sample((i + 0.5) / kSamples, color));
  return sum / kSamples;
}

class FormulaTest : public testing::TestWithParam<PhaseFunction> {};

// Linear interpolation between 8193 nodes is off by at most 2e-5 of the value, for the sharpest of
// these functions.
TEST_P(FormulaTest, ValueIsTheFormula) {
  const SampledPhase phase = SampledPhase::Of(GetParam());
  for (double angle_deg = 0.0; angle_deg <= 180.0; angle_deg += 0.37) {
    const double mu = std::cos(angle_deg * std::numbers::pi / 180.0);
    const double expected = physics::PhaseValue(GetParam(), mu);
    EXPECT_NEAR(phase.Value(mu).y, expected, 2e-5 * expected) << angle_deg;
  }
}

TEST_P(FormulaTest, SampleInvertsTheCumulativePhase) {
  const SampledPhase phase = SampledPhase::Of(GetParam());
  for (const double u : {1e-9, 1e-4, 0.01, 0.2, 0.5, 0.77, 0.95, 0.9999, 1.0 - 1e-9}) {
    const PhaseSample sample = phase.Sample(u, 0);
    EXPECT_EQ(sample.weight, glm::dvec3(1.0));
    const double angle_rad = std::acos(sample.mu);
    EXPECT_NEAR(physics::CumulativePhase(GetParam(), angle_rad), u, 2e-6) << u;
  }
}

TEST_P(FormulaTest, SamplesHaveTheMeanCosine) {
  const SampledPhase phase = SampledPhase::Of(GetParam());
  EXPECT_NEAR(MeanOverSamples(phase, [](const PhaseSample& sample) { return sample.mu; }),
              physics::MeanCosine(GetParam()), 2e-6);
  EXPECT_NEAR(phase.Asymmetry(), physics::MeanCosine(GetParam()), 1e-5);
}

INSTANTIATE_TEST_SUITE_P(Formulas, FormulaTest,
                         testing::Values(PhaseFunction{PhaseKind::kHenyeyGreenstein, 0.0F},
                                         PhaseFunction{PhaseKind::kHenyeyGreenstein, 5e-5F},
                                         PhaseFunction{PhaseKind::kHenyeyGreenstein, 2e-4F},
                                         PhaseFunction{PhaseKind::kHenyeyGreenstein, 0.75F},
                                         PhaseFunction{PhaseKind::kHenyeyGreenstein, -0.6F},
                                         PhaseFunction{PhaseKind::kHenyeyGreenstein, 0.99F},
                                         PhaseFunction{PhaseKind::kCornetteShanks, 0.0F},
                                         PhaseFunction{PhaseKind::kCornetteShanks, 0.85F},
                                         PhaseFunction{PhaseKind::kCornetteShanks, 0.979F},
                                         PhaseFunction{PhaseKind::kRayleigh, 0.0F}));

// Samples are linear between table values at most 0.04 degrees apart, which cuts the corners off
// the table's halos and bows.
class TableTest : public testing::TestWithParam<PhaseFunction> {};

TEST_P(TableTest, ValuesAndSamplesAreTheTables) {
  const SampledPhase phase = SampledPhase::Of(GetParam());
  for (double angle_deg = 0.0; angle_deg <= 180.0; angle_deg += 0.37) {
    const auto table = [&](double away_deg) {
      const double angle_rad = (angle_deg + away_deg) * std::numbers::pi / 180.0;
      return physics::PhaseColors(GetParam(), std::cos(angle_rad));
    };
    const glm::dvec3 low = glm::min(table(0.0), glm::min(table(-0.04), table(0.04)));
    const glm::dvec3 high = glm::max(table(0.0), glm::max(table(-0.04), table(0.04)));
    const glm::dvec3 value = phase.Value(std::cos(angle_deg * std::numbers::pi / 180.0));
    for (int c = 0; c < 3; ++c) {
      EXPECT_GE(value[c], low[c] * (1.0 - 1e-3)) << angle_deg;
      EXPECT_LE(value[c], high[c] * (1.0 + 1e-3)) << angle_deg;
    }
  }
  glm::dvec3 mean_cosine(0.0);
  for (int c = 0; c < 3; ++c) {
    mean_cosine[c] =
        MeanOverSamples(phase, [c](const PhaseSample& s) { return s.weight[c] * s.mu; });
  }
  EXPECT_NEAR(glm::dot(physics::kLuminance, mean_cosine), physics::MeanCosine(GetParam()), 2e-4);
}

INSTANTIATE_TEST_SUITE_P(Tables, TableTest,
                         testing::Values(PhaseFunction{PhaseKind::kWaterDroplets, 0.0F, 1e-5F},
                                         PhaseFunction{PhaseKind::kWaterDroplets, 0.0F, 5e-4F},
                                         PhaseFunction{PhaseKind::kIceColumns},
                                         PhaseFunction{PhaseKind::kIceRough}));

// A diffraction peak 0.02 degrees wide is added to a constant, so its share of the light is known.
// The trapezoidal rule between nodes misses 1.2e-4 of a peak this sharp.
TEST(TabulatedPhase, ResolvesADiffractionPeak) {
  constexpr double kWidth_rad = 3.5e-4;
  const double height = 4.0 / (kWidth_rad * kWidth_rad);
  const SampledPhase phase = SampledPhase::Tabulated([&](double mu) {
    return 1.0 + height * std::exp(-2.0 * (1.0 - mu) / (kWidth_rad * kWidth_rad));
  });
  // The integral over x = 1 - mu is 2 for the constant and 2 for the peak.
  EXPECT_NEAR(phase.Value(0.0).x, 0.5, 1e-4);
  EXPECT_NEAR(phase.Value(1.0).x, 0.5 * (1.0 + height), 1e-4 * height);
  const double within = MeanOverSamples(
      phase, [](const PhaseSample& sample) { return sample.mu > std::cos(0.01) ? 1.0 : 0.0; });
  EXPECT_NEAR(within, 0.5, 2e-5 + 1e-4);
}

TEST(TabulatedPhase, EachColorHasItsOwnSamples) {
  const auto of = [](float g) {
    return [g](double mu) { return physics::PhaseValue({PhaseKind::kHenyeyGreenstein, g}, mu); };
  };
  const SampledPhase phase = SampledPhase::Tabulated({of(0.8F), of(0.7F), of(0.2F)});
  constexpr glm::dvec3 kMeanCosines(0.8, 0.7, 0.2);
  for (int color = 0; color < 3; ++color) {
    const auto index = static_cast<std::size_t>(color);
    EXPECT_NEAR(MeanOverSamples(
                    phase, [](const PhaseSample& s) { return s.mu; }, index),
                kMeanCosines[color], 1e-5);
    EXPECT_NEAR(phase.Value(0.3)[color], of(static_cast<float>(kMeanCosines[color]))(0.3), 1e-5);
    // A weight is the ratio between the colour's own probability density there and that of the
    // sample.
    const PhaseSample sample = phase.Sample(0.4, index);
    const glm::dvec3 value = phase.Value(sample.mu);
    for (int other = 0; other < 3; ++other) {
      EXPECT_NEAR(sample.weight[other], value[other] / value[color], 1e-6);
    }
  }
}

TEST(TabulatedPhase, ZeroOverPartOfTheSphere) {
  const SampledPhase phase =
      SampledPhase::Tabulated([](double mu) { return mu < 0.0 ? 1.0 : 0.0; });
  for (const double u : {1e-9, 0.3, 1.0 - 1e-9}) EXPECT_LT(phase.Sample(u, 0).mu, 1e-3);
  EXPECT_NEAR(phase.Value(-0.5).x, 2.0, 1e-3);
  EXPECT_EQ(phase.Value(0.5).x, 0.0);
}

}  // namespace
}  // namespace thunderhead::reference
