#include "physics/hydrometeors.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <set>
#include <string_view>

#include "gtest/gtest.h"
#include "physics/air.h"
#include "physics/particle_size.h"

namespace thunderhead::physics {
namespace {

TEST(Hydrometeors, OneGramOfCloudWaterPerKilogram) {
  // 3 * 1 kg/m3 * 1e-3 / (2 * 1000 kg/m3 * 1e-5 m) = 0.15 1/m.
  const ParticleOptics& cloud = DefaultOptics(Hydrometeor::kCloud);
  const float concentration_kg_per_m3 = 1e-3F;
  EXPECT_NEAR(
      concentration_kg_per_m3 * MassExtinction_m2_per_kg(cloud.density_kg_per_m3, cloud.radius_m),
      0.15F, 1e-6F);
}

TEST(Hydrometeors, MassExtinctionIsNearPublishedTables) {
  // The published values are mass extinctions in m2/kg from ecRad's tables at 0.55 um. Geometric
  // optics neglects the edge terms, which grow as particles shrink. A tolerance of 5 % is
  // sufficient for droplets of 10 um.
  struct Row {
    float density_kg_per_m3, radius_m, published_m2_per_kg;
  };
  for (const Row& row :
       {Row{1000, 10e-6F, 157.2F}, Row{1000, 20e-6F, 77.3F}, Row{1000, 100e-6F, 15.16F},
        Row{917, 30e-6F, 54.58F}, Row{917, 60e-6F, 27.26F}}) {
    const float ours = MassExtinction_m2_per_kg(row.density_kg_per_m3, row.radius_m);
    EXPECT_NEAR(ours / row.published_m2_per_kg, 1.0F, 0.05F) << row.radius_m;
  }
}

TEST(Hydrometeors, EffectiveRadiusFromTheMassOfAMeanParticle) {
  // A droplet has a mass of 1e-11 kg if, for example, 1 g of cloud water is spread over 1e8
  // droplets. A sphere of that mass has a radius of 13.365 um. The effective radius of droplets
  // with this mean mass is 1.1157 times as large, because their sizes vary.
  EXPECT_NEAR(EffectiveRadius_m(Hydrometeor::kCloud, 1e-11F), 1.1157 * 13.365e-6, 1e-9);
  // A sphere of water of this mass has a radius of 1 mm. An exponential distribution with this mean
  // mass has a mean diameter of 1.1006 mm, and its effective radius is 3/2 of its mean diameter.
  const double mass_kg = 4.18879e-6;
  EXPECT_NEAR(EffectiveRadius_m(Hydrometeor::kRain, static_cast<float>(mass_kg)), 1.651e-3, 1e-6);
  const double snow_m = EffectiveRadius_m(Hydrometeor::kSnow, static_cast<float>(mass_kg));
  EXPECT_NEAR(snow_m / 1.651e-3, std::cbrt(10.0), 1e-3) << "ten times less dense";
}

TEST(Hydrometeors, DefaultPhasesAreTables) {
  const auto kind = [](Hydrometeor hydrometeor) { return DefaultOptics(hydrometeor).phase.kind; };
  EXPECT_EQ(kind(Hydrometeor::kCloud), PhaseKind::kWaterDroplets);
  EXPECT_EQ(kind(Hydrometeor::kRain), PhaseKind::kWaterDroplets);
  EXPECT_EQ(kind(Hydrometeor::kIce), PhaseKind::kIceColumns);
  EXPECT_EQ(kind(Hydrometeor::kSnow), PhaseKind::kIceRough);
  EXPECT_EQ(kind(Hydrometeor::kGraupel), PhaseKind::kIceRough);
  EXPECT_EQ(kind(Hydrometeor::kHail), PhaseKind::kIceRough);
}

TEST(Hydrometeors, PapersConstantsAreTheirTables) {
  EXPECT_FLOAT_EQ(PapersRadius_m(Hydrometeor::kCloud), 1e-5F);
  EXPECT_FLOAT_EQ(PapersRadius_m(Hydrometeor::kRain), 1e-3F);
  EXPECT_FLOAT_EQ(PapersRadius_m(Hydrometeor::kIce), 1e-3F);
  EXPECT_FLOAT_EQ(PapersRadius_m(Hydrometeor::kSnow), 2e-3F);
  EXPECT_FLOAT_EQ(PapersRadius_m(Hydrometeor::kGraupel), 2.5e-3F);
}

TEST(Hydrometeors, FalseColoursAreOkabeAndItos) {
  const auto encoded = [](float linear) {
    const double value =
        linear <= 0.0031308F ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
    return static_cast<int>(std::lround(255 * value));
  };
  const std::array<std::array<int, 3>, kHydrometeorCount> colors = {{{0xE6, 0x9F, 0x00},
                                                                     {0x56, 0xB4, 0xE9},
                                                                     {0xCC, 0x79, 0xA7},
                                                                     {0xF0, 0xE4, 0x42},
                                                                     {0x00, 0x9E, 0x73},
                                                                     {0xD5, 0x5E, 0x00}}};
  for (const Hydrometeor hydrometeor : kHydrometeors) {
    const glm::vec3 color = DefaultOptics(hydrometeor).false_color;
    for (int channel = 0; channel < 3; ++channel) {
      EXPECT_EQ(encoded(color[channel]),
                colors[IndexOf(hydrometeor)][static_cast<std::size_t>(channel)])
          << NameOf(hydrometeor);
    }
  }
}

// Compares with observed exponential distributions at 1 g/m3: 3/2 over the fourth root of pi rho N0
// / 1e-3.
TEST(Hydrometeors, DefaultRadiiAreObserved) {
  struct Row {
    Hydrometeor hydrometeor;
    double intercept_per_m4;
  };
  for (const Row& row :
       {Row{Hydrometeor::kRain, 8e6}, Row{Hydrometeor::kSnow, 2e6 * std::exp(0.12 * 20.0)},
        Row{Hydrometeor::kGraupel, 4e6}, Row{Hydrometeor::kHail, 4e4}}) {
    const ParticleOptics& optics = DefaultOptics(row.hydrometeor);
    const double slope_per_m =
        std::pow(3.14159265 * optics.density_kg_per_m3 * row.intercept_per_m4 / 1e-3, 0.25);
    EXPECT_NEAR(optics.radius_m * slope_per_m / 1.5, 1.0, 0.01) << NameOf(row.hydrometeor);
  }
  EXPECT_FLOAT_EQ(DefaultOptics(Hydrometeor::kCloud).radius_m, 1e-5F);
  EXPECT_FLOAT_EQ(DefaultOptics(Hydrometeor::kIce).radius_m, 3e-5F);
}

TEST(Hydrometeors, TheConstantRadiusIsThatOfTheSource) {
  EXPECT_FLOAT_EQ(ConstantRadius_m(Hydrometeor::kIce, SizeSource::kModel, 7e-5F), 3e-5F);
  EXPECT_FLOAT_EQ(ConstantRadius_m(Hydrometeor::kIce, SizeSource::kPapers, 7e-5F), 1e-3F);
  EXPECT_FLOAT_EQ(ConstantRadius_m(Hydrometeor::kIce, SizeSource::kGiven, 7e-5F), 7e-5F);
}

TEST(Hydrometeors, EachHasItsOwnName) {
  std::set<std::string_view> names;
  for (Hydrometeor hydrometeor : kHydrometeors) names.insert(NameOf(hydrometeor));
  EXPECT_EQ(names.size(), kHydrometeorCount);
  EXPECT_FALSE(names.contains(""));
}

TEST(Air, DensityOfDryAndMoistAir) {
  // 1e5 / (287 * 300) = 1.16144 kg/m3. 10 g/kg of vapour divides it by 1.01608.
  EXPECT_NEAR(DryAirDensity_kg_per_m3(1e5, 300.0, 0.0), 1.16144, 1e-5);
  EXPECT_NEAR(DryAirDensity_kg_per_m3(1e5, 300.0, 0.01), 1.14306, 1e-5);
}

TEST(Air, TemperatureFromPotentialTemperature) {
  EXPECT_DOUBLE_EQ(Temperature_K(300.0, 1e5), 300.0);
  // 300 * 0.5^(287/1004.5) = 246.10 K.
  EXPECT_NEAR(Temperature_K(300.0, 5e4), 246.10, 0.01);
}

}  // namespace
}  // namespace thunderhead::physics
