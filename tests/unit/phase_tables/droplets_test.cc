#include "physics/droplets.h"

#include <cmath>
#include <numbers>

#include "gtest/gtest.h"
#include "physics/mie.h"
#include "physics/phase_accumulator.h"
#include "physics/refractive_index.h"
#include "physics/tables/recipes.h"

namespace thunderhead::physics {
namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;
constexpr std::size_t kGreenColor = 1;

TEST(RefractiveIndex, WaterIsAsPublished) {
  // The value is from Tilton and Taylor 1938, for sodium light and water at 10 degrees in air:
  // 1.33369.
  EXPECT_NEAR(WaterRefractiveIndex(0.5893), 1.33369, 1e-4);
  // The values are from Hale and Querry 1973 at 25 degrees, where the index is lower by 0.0012,
  // with three decimals.
  EXPECT_NEAR(WaterRefractiveIndex(0.65) - 0.0012, 1.331, 1e-3);
  EXPECT_NEAR(WaterRefractiveIndex(0.55) - 0.0012, 1.333, 1e-3);
  EXPECT_NEAR(WaterRefractiveIndex(0.45) - 0.0012, 1.337, 2e-3);
}

TEST(DropletSizes, QuadratureHasTheMomentsOfTheDistribution) {
  const DropletSizes sizes{10.0, 0.1};
  const SizeQuadrature quadrature = QuadratureOf(sizes, 200);
  double mean = 0.0;
  double square = 0.0;
  for (std::size_t i = 0; i < quadrature.radii_um.size(); ++i) {
    mean += quadrature.area_shares[i] * quadrature.radii_um[i];
    square += quadrature.area_shares[i] * quadrature.radii_um[i] * quadrature.radii_um[i];
  }
  EXPECT_NEAR(mean, 10.0, 1e-4);
  EXPECT_NEAR(square / (mean * mean) - 1.0, 0.1, 1e-4);
}

// Compares the asymmetry and the mass extinction of cloud at 0.55 um with ecRad's tables, for
// several effective radii. The tables use a refractive index of water that differs by up to 0.002,
// and a slightly different size distribution. The asymmetry may therefore differ by 0.003, and the
// extinction by 1 %.
TEST(Droplets, CloudIsAsPublished) {
  const struct {
    double radius_um, asymmetry;
  } cases[] = {{5.0, 0.846}, {10.0, 0.862}, {20.0, 0.872}};
  for (const auto& expected : cases) {
    const DropletOptics optics = OpticsOf({expected.radius_um, 0.1}, 2000);
    EXPECT_NEAR(optics.asymmetry[kGreenColor], expected.asymmetry, 0.003) << expected.radius_um;
    EXPECT_NEAR(optics.albedo[kGreenColor], 1.0, 1e-5);
  }
  const auto mass_extinction = [](double radius_um) {
    const DropletSizes sizes{radius_um, 0.1};
    return MassExtinction_m2_per_kg(sizes, OpticsOf(sizes, 2000).extinction[kGreenColor]);
  };
  EXPECT_NEAR(mass_extinction(10.0) / 157.2, 1.0, 0.01);
  EXPECT_NEAR(mass_extinction(20.0) / 77.3, 1.0, 0.01);
}

// Extinction tends to twice the geometric cross section, from above as x^(-2/3). The edge term is
// that of van de Hulst 1957, section 17.26: Q = 2 + 1.992 x^(-2/3).
TEST(Droplets, LargeDropsApproachGeometricOptics) {
  const DropletSizes sizes{100.0, 0.1};
  const double x = 2.0 * std::numbers::pi * 100.0 / kWavelengthsUm[kGreenColor];
  const double extinction = OpticsOf(sizes, 100).extinction[kGreenColor];
  EXPECT_GT(extinction, 2.0);
  // The mean of x^(-2/3) over the sizes is within a tenth of its value at the effective size.
  EXPECT_NEAR(extinction, 2.0 + 1.992 * std::pow(x, -2.0 / 3.0),
              0.1 * 1.992 * std::pow(x, -2.0 / 3.0));
}

TEST(Droplets, TableHoldsAllThatIsScattered) {
  const DropletSizes sizes{3.0, 0.1};
  const std::vector<double> angles = AngleGrid({{10, 0.25}, {180, 0.5}});
  const PhaseAccumulator light = ScatterByDroplets(sizes, angles, 64, 3, {});
  const DropletOptics optics = OpticsOf(sizes, 64);
  const auto table = PhaseTable::Create({"test", kWavelengthsUm, angles, light.Values()}, 1e-9);
  ASSERT_TRUE(table.ok()) << table.status();
  for (std::size_t c = 0; c < kPhaseChannels; ++c) {
    EXPECT_NEAR(2.0 * light.energy()[c], optics.extinction[c] * optics.albedo[c], 1e-6);
    // The grid's steps, up to h = 0.5 degrees, widen angles by h^2 / 6 on average, which is below
    // 1e-4 of g.
    EXPECT_NEAR(table->Asymmetry(c), optics.asymmetry[c], 1e-4);
  }
}

TEST(Droplets, SameBitsOnAnyNumberOfThreads) {
  const std::vector<double> angles = AngleGrid({{180, 2}});
  const auto values = [&](int threads) {
    return ScatterByDroplets({2.0, 0.1}, angles, 96, 2, {.threads = threads}).Values();
  };
  EXPECT_EQ(values(1), values(3));
}

TEST(Droplets, SmallRunAgreesWithTheFile) {
  DropletRecipe recipe = DropletRecipes().front();
  ASSERT_EQ(recipe.name, "cloud_re05");
  recipe.radii = 1000;
  const PhaseTable small = Build(recipe, {.threads = 2}).table;
  const auto file = EmbeddedPhaseTable(recipe.name);
  ASSERT_TRUE(file.ok()) << file.status();
  ASSERT_EQ(small.angles_deg().size(), file->angles_deg().size());
  for (std::size_t c = 0; c < kPhaseChannels; ++c) {
    EXPECT_NEAR(small.Asymmetry(c), file->Asymmetry(c), 1e-3);
    for (double angle_deg = 0.0; angle_deg <= 180.0; angle_deg += 1.5) {
      // The computed table has a quarter of the drop sizes, so the resonances of single drops
      // average out less well.
      EXPECT_NEAR(small.Value(angle_deg * kRadiansPerDegree, c) /
                      file->Value(angle_deg * kRadiansPerDegree, c),
                  1.0, 0.1)
          << angle_deg << " channel " << c;
    }
  }
}

// The primary rainbow of a few large drops is computed directly.
TEST(Droplets, RainbowOfAFewDropsAgreesWithTheFile) {
  const auto file = EmbeddedPhaseTable("rain");
  ASSERT_TRUE(file.ok()) << file.status();
  const SizeQuadrature drops = QuadratureOf(DropletSizes{500.0, 0.1}, 40);
  std::vector<double> cosines;
  for (int i = 0; i < 250; ++i) cosines.push_back(std::cos((136.0 + 0.02 * i) * kRadiansPerDegree));
  std::vector<double> sums(cosines.size());
  double scattering = 0.0;
  for (std::size_t i = 0; i < drops.radii_um.size(); ++i) {
    const double x = 2.0 * std::numbers::pi * drops.radii_um[i] / kWavelengthsUm[kGreenColor];
    const MieSeries series(x, WaterRefractiveIndex(kWavelengthsUm[kGreenColor]));
    series.AddIntensities(cosines, drops.area_shares[i] / (x * x), sums);
    scattering += drops.area_shares[i] * series.Efficiencies().scattering;
  }
  double few = 0.0;
  double table = 0.0;
  for (int i = 0; i < 250; ++i) {
    few += 4.0 * sums[static_cast<std::size_t>(i)] / scattering;
    table += file->Value((136.0 + 0.02 * i) * kRadiansPerDegree, kGreenColor);
  }
  // Compares means over five degrees. The remaining differences are ripples from only 40 sizes.
  EXPECT_NEAR(few / table, 1.0, 0.05);
}

}  // namespace
}  // namespace thunderhead::physics
