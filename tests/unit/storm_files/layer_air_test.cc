#include "storm_files/layer_air.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace thunderhead::storm_files {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::IsNan;

constexpr float kMissingAir = std::numeric_limits<float>::quiet_NaN();

TEST(DryAirDensity, AgreesWithAValueComputedByHand) {
  // T = 310 * 0.8^(2/7) = 290.853 K; rho = 80000 / (287 * 290.853 * (1 + 1.608 * 0.01)) = 0.94321
  // kg/m3.
  EXPECT_NEAR(DryAirDensity({{80'000}, {310}, {0.01F}}, {0, 100}, 1)[0], 0.94321, 1e-5);
  // Without vapour: 80000 / (287 * 290.853) = 0.95838 kg/m3.
  EXPECT_NEAR(DryAirDensity({{80'000}, {310}, {}}, {0, 100}, 1)[0], 0.95838, 1e-5);
}

TEST(DryAirDensity, IsMissingWhereAnythingItNeedsIs) {
  EXPECT_TRUE(std::isnan(DryAirDensity({{kMissingAir}, {310}, {0.01F}}, {0, 100}, 1)[0]));
  EXPECT_TRUE(std::isnan(DryAirDensity({{80'000}, {kMissingAir}, {0.01F}}, {0, 100}, 1)[0]));
  EXPECT_TRUE(std::isnan(DryAirDensity({{80'000}, {310}, {kMissingAir}}, {0, 100}, 1)[0]));
  EXPECT_TRUE(std::isnan(DryAirDensity({{80'000}, {310}, {0.01F}}, {0, kMissingAir}, 1)[0]));
  EXPECT_TRUE(std::isnan(DryAirDensity({{80'000}, {310}, {0.01F}}, {100, 0}, 1)[0]));
  EXPECT_TRUE(std::isnan(DryAirDensity({{-999}, {310}, {0.01F}}, {0, 100}, 1)[0]));
  EXPECT_TRUE(std::isnan(DryAirDensity({{80'000}, {-699}, {0.01F}}, {0, 100}, 1)[0]));
}

TEST(AirTemperature, IsFrom100To400Kelvin) {
  const LayerState given{{}, {}, {}, {99.9F, 100.0F, 400.0F, 400.1F, kMissingAir}};
  EXPECT_THAT(Temperature(given), ElementsAre(IsNan(), 100.0F, 400.0F, IsNan(), IsNan()));
  // At 100 hPa, a potential temperature of 500 K is one of 500 * 0.1^(2/7) = 258.974 K.
  const LayerState potential{{10'000, 10'000, 90'000}, {500, 900, 500}, {}};
  EXPECT_THAT(Temperature(potential),
              ElementsAre(::testing::FloatNear(258.974F, 0.01F), IsNan(), IsNan()));
}

TEST(DryAirDensity, TakesVapourThatUndershootsAsZero) {
  EXPECT_EQ(DryAirDensity({{80'000}, {310}, {-1e-9F}}, {0, 100}, 1)[0],
            DryAirDensity({{80'000}, {310}, {0.0F}}, {0, 100}, 1)[0]);
}

TEST(ImpossibleVapour, IsOnlyLookedForInUsableAir) {
  const LayerState state{{80'000, 80'000, kMissingAir, 80'000}, {310, 310, 310, 5000}, {}};
  const auto largest = [&](const std::vector<float>& vapour, float second_top_m) {
    LayerState with_vapour = state;
    with_vapour.vapour_kg_per_kg = vapour;
    return ImpossibleVapour(with_vapour, {0, 0, 0, 0, 100, second_top_m, 100, 100}, 4);
  };
  EXPECT_EQ(largest({0.1F, 0.04F, 9.0F, 9.0F}, 100.0F), std::nullopt);
  EXPECT_EQ(largest({12.0F, 16.0F, 90.0F, 90.0F}, 100.0F), 16.0F);
  EXPECT_EQ(largest({12.0F, 16.0F, 90.0F, 90.0F}, 0.0F), 12.0F) << "the second layer is buried";
  EXPECT_EQ(largest({0.01F, kMissingAir, 0.0F, 0.0F}, 100.0F), std::nullopt);
  EXPECT_EQ(largest({}, 100.0F), std::nullopt);
}

TEST(GeopotentialToHeight, DividesTheSumByGravity) {
  std::vector<float> values = {981, kMissingAir, 9.81e8F};
  GeopotentialToHeight({9810, 0, 0}, values);
  EXPECT_FLOAT_EQ(values[0], 1100.0F);
  EXPECT_TRUE(std::isnan(values[1]));
  EXPECT_TRUE(std::isnan(values[2])) << "a hundred thousand kilometres up is no height";
}

TEST(InterfacesBetween, LieHalfWayAndBeginAtTheGround) {
  const auto faces = [](const std::vector<float>& middles_m, const std::vector<float>& ground_m) {
    return InterfacesBetween(middles_m, ground_m, static_cast<int>(middles_m.size()), 1);
  };
  const float missing = std::nanf("");
  EXPECT_THAT(faces({100.0F, 300.0F, 700.0F}, {20.0F}), ElementsAre(20.0F, 200.0F, 500.0F, 900.0F));
  // A ground that is not known, or not below the lowest middle, is not used.
  const std::vector<std::vector<float>> unusable = {{}, {missing}, {150.0F}};
  for (const std::vector<float>& ground_m : unusable) {
    EXPECT_THAT(faces({100.0F, 300.0F, 700.0F}, ground_m),
                ElementsAre(0.0F, 200.0F, 500.0F, 900.0F));
  }
  // Levels that begin far above the ground have no layer between it and the lowest level.
  EXPECT_THAT(faces({3000.0F, 3400.0F, 3800.0F}, {20.0F}),
              ElementsAre(2800.0F, 3200.0F, 3600.0F, 4000.0F));
  // Levels under the ground may have no heights.
  EXPECT_THAT(faces({missing, 300.0F, 700.0F}, {250.0F}),
              ElementsAre(IsNan(), 250.0F, 500.0F, 900.0F));
  EXPECT_THAT(faces({300.0F}, {100.0F}), ElementsAre(100.0F, 500.0F));
  EXPECT_THAT(faces({300.0F}, {}), Each(IsNan()));
}

}  // namespace
}  // namespace thunderhead::storm_files
