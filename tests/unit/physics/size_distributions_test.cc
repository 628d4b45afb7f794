// Tests of effective radii, which follow from the size distributions of microphysics schemes. The
// expected values are computed by hand.
#include "physics/size_distributions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "physics/particle_size.h"

namespace thunderhead::physics {
namespace {

struct Row {
  Microphysics microphysics;
  Hydrometeor hydrometeor;
  float content_kg_per_m3;
  float temperature_K;
  double radius_m;
};

void ExpectRadius(const Row& row) {
  EXPECT_NEAR(DistributionRadius_m(row.microphysics, row.hydrometeor, row.content_kg_per_m3,
                                   row.temperature_K) /
                  row.radius_m,
              1.0, 2e-4)
      << NameOf(row.microphysics) << " " << NameOf(row.hydrometeor) << " " << row.content_kg_per_m3
      << " kg/m3 at " << row.temperature_K << " K";
}

TEST(SizeDistributions, OfWsm6) {
  for (const Row& row : {
           // 1.5 (C / (pi 1000 3e8))^(1/3)
           Row{Microphysics::kWsm6, Hydrometeor::kCloud, 1e-3F, 280.0F, 1.52992e-5},
           Row{Microphysics::kWsm6, Hydrometeor::kCloud, 1e-4F, 280.0F, 7.1012e-6},
           // 1.5 (C / (pi 1000 8e6))^(1/4)
           Row{Microphysics::kWsm6, Hydrometeor::kRain, 1e-3F, 280.0F, 6.6993e-4},
           Row{Microphysics::kWsm6, Hydrometeor::kRain, 1e-2F, 280.0F, 1.19133e-3},
           // 0.12225 x 11.9 (C / (5.38e7 C^0.75))^(1/2): 53,800 and 9567 crystals
           Row{Microphysics::kWsm6, Hydrometeor::kIce, 1e-4F, 220.0F, 6.2720e-5},
           Row{Microphysics::kWsm6, Hydrometeor::kIce, 1e-5F, 220.0F, 4.7033e-5},
           // 1.5 (C / (pi 100 N0))^(1/4), N0 2.2046e7 at 20 and 2.4302e8 at 40 degrees of frost
           Row{Microphysics::kWsm6, Hydrometeor::kSnow, 1e-3F, 253.16F, 9.2463e-4},
           Row{Microphysics::kWsm6, Hydrometeor::kSnow, 1e-4F, 233.16F, 2.8536e-4},
           // 1.5 (C / (pi 500 4e6))^(1/4)
           Row{Microphysics::kWsm6, Hydrometeor::kGraupel, 1e-3F, 260.0F, 9.4743e-4},
           Row{Microphysics::kWsm6, Hydrometeor::kGraupel, 1e-2F, 260.0F, 1.68479e-3},
           // 1.5 (C / (pi 700 4e4))^(1/4), times 700 / 500
           Row{Microphysics::kWsm6WithHail, Hydrometeor::kGraupel, 1e-3F, 260.0F, 2.75432e-3 * 1.4},
           Row{Microphysics::kWsm6WithHail, Hydrometeor::kRain, 1e-3F, 280.0F, 6.6993e-4},
       }) {
    ExpectRadius(row);
  }
}

TEST(SizeDistributions, OfWsm6HaveItsLimits) {
  for (const Row& row : {
           Row{Microphysics::kWsm6, Hydrometeor::kCloud, 4e-6F, 280.0F, 2.51e-6},
           Row{Microphysics::kWsm6, Hydrometeor::kCloud, 4e-2F, 280.0F, 50e-6},
           // The slope is 80,000, 100,000, 60,000 and 20,000 per m at most.
           Row{Microphysics::kWsm6, Hydrometeor::kRain, 1e-12F, 280.0F, 1.875e-5},
           Row{Microphysics::kWsm6, Hydrometeor::kSnow, 1e-12F, 260.0F, 1.5e-5},
           Row{Microphysics::kWsm6, Hydrometeor::kGraupel, 1e-12F, 260.0F, 2.5e-5},
           Row{Microphysics::kWsm6WithHail, Hydrometeor::kGraupel, 1e-12F, 260.0F, 7.5e-5 * 1.4},
           Row{Microphysics::kWsm6, Hydrometeor::kIce, 1e-8F, 220.0F, 10e-6},
           Row{Microphysics::kWsm6, Hydrometeor::kIce, 1e-2F, 220.0F, 125e-6},
           // The number is bounded by 1000 and 1e6 crystals per m3, at C = 4e-7 and 7.3e-3.
           Row{Microphysics::kWsm6, Hydrometeor::kIce, 4e-7F, 220.0F, 2.9095e-5},
           Row{Microphysics::kWsm6, Hydrometeor::kIce, 7.3e-3F, 220.0F, 1.24296e-4},
           // The intercept is 2e6 above freezing, and 1e11 from 90 degrees of frost on.
           Row{Microphysics::kWsm6, Hydrometeor::kSnow, 1e-3F, 273.16F, 1.68479e-3},
           Row{Microphysics::kWsm6, Hydrometeor::kSnow, 1e-3F, 300.0F, 1.68479e-3},
           Row{Microphysics::kWsm6, Hydrometeor::kSnow, 1e-3F, 150.0F, 1.12669e-4},
       }) {
    ExpectRadius(row);
  }
}

TEST(SizeDistributions, OfThompson) {
  for (const Row& row : {
           // 7.5 (C / (pi / 6 1000 1e8 13 14 15))^(1/3)
           Row{Microphysics::kThompson, Hydrometeor::kCloud, 1e-3F, 280.0F, 1.43441e-5},
           Row{Microphysics::kThompson, Hydrometeor::kCloud, 1e-4F, 280.0F, 6.6580e-6},
           Row{Microphysics::kThompson, Hydrometeor::kCloud, 1e-9F, 280.0F, 2.51e-6},
           // The intercept is 10^(3 + 2/7 (log10 C + 8)) = 26,827 and 51,795, and the slope 428.49
           // and 284.04. The radius is 1.5 / slope for 400 kg/m3, as for 500.
           Row{Microphysics::kThompson, Hydrometeor::kGraupel, 1e-3F, 260.0F, 2.80050e-3},
           Row{Microphysics::kThompson, Hydrometeor::kGraupel, 1e-2F, 260.0F, 4.22481e-3},
           // The distribution is never finer than a median volume diameter of 50 um.
           Row{Microphysics::kThompson, Hydrometeor::kGraupel, 1e-15F, 260.0F, 1.63399e-5},
       }) {
    ExpectRadius(row);
  }
}

// The extinction per mass must be that of the scheme's own particles, whatever density is drawn.
// For an exponential distribution the extinction per mass is twice the particles' area, pi N0 /
// slope^3, divided by the water content.
TEST(SizeDistributions, KeepTheExtinctionOfParticlesOfAnotherDensity) {
  const float radius_m =
      DistributionRadius_m(Microphysics::kThompson, Hydrometeor::kGraupel, 1e-3F, 260.0F);
  const ParticleOptics& optics = DefaultOptics(Hydrometeor::kGraupel);
  const double expected_m2_per_kg = 3.14159265 * 26827.0 / std::pow(428.4946, 3.0) / 1e-3;
  EXPECT_NEAR(MassExtinction_m2_per_kg(optics.density_kg_per_m3, radius_m) / expected_m2_per_kg,
              1.0, 1e-3);
}

TEST(SizeDistributions, OfTracesAreWithinTheLimitsOfARadius) {
  for (const Microphysics microphysics :
       {Microphysics::kWsm6, Microphysics::kWsm6WithHail, Microphysics::kThompson}) {
    for (const Hydrometeor hydrometeor : kHydrometeors) {
      if (!HasDistribution(microphysics, hydrometeor)) continue;
      for (const float content :
           {std::numeric_limits<float>::denorm_min(), 1e-42F, 1e-38F, 1e-20F, 1e-6F, 1.0F, 1e6F}) {
        const float radius_m = DistributionRadius_m(microphysics, hydrometeor, content, 250.0F);
        EXPECT_GE(radius_m, kMinRadius_m) << NameOf(hydrometeor) << " " << content;
        EXPECT_LE(radius_m, kMaxRadius_m) << NameOf(hydrometeor) << " " << content;
      }
    }
  }
}

TEST(SizeDistributions, AreKnownOfWhatASchemeHas) {
  EXPECT_FALSE(HasDistribution(Microphysics::kUnknown, Hydrometeor::kCloud));
  EXPECT_FALSE(HasDistribution(Microphysics::kWsm6, Hydrometeor::kHail));
  EXPECT_FALSE(HasDistribution(Microphysics::kThompson, Hydrometeor::kSnow));
  EXPECT_FALSE(HasDistribution(Microphysics::kThompson, Hydrometeor::kRain));
  EXPECT_EQ(NameOf(Microphysics::kUnknown), "");
}

}  // namespace
}  // namespace thunderhead::physics
