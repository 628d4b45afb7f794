#include "storm_files/layer_air.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace thunderhead::storm_files {
namespace {

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

TEST(DryAirDensity, TakesVapourThatUndershootsAsZero) {
  EXPECT_EQ(DryAirDensity({{80'000}, {310}, {-1e-9F}}, {0, 100}, 1)[0],
            DryAirDensity({{80'000}, {310}, {0.0F}}, {0, 100}, 1)[0]);
}

TEST(GeopotentialToHeight, DividesTheSumByGravity) {
  std::vector<float> values = {981, kMissingAir, 9.81e8F};
  GeopotentialToHeight({9810, 0, 0}, values);
  EXPECT_FLOAT_EQ(values[0], 1100.0F);
  EXPECT_TRUE(std::isnan(values[1]));
  EXPECT_TRUE(std::isnan(values[2])) << "a hundred thousand kilometres up is no height";
}

}  // namespace
}  // namespace thunderhead::storm_files
