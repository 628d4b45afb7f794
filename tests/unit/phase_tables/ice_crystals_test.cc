#include "physics/ice_crystals.h"
#include "physics/atmosphere.h"

#include <cmath>
#include <numbers>

#include "glm/geometric.hpp"
#include "gtest/gtest.h"
#include "physics/fresnel.h"
#include "physics/hexagonal_prism.h"
#include "physics/refractive_index.h"
#include "physics/tables/recipes.h"

namespace thunderhead::physics {
namespace {

using glm::dvec3;

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180.0;
constexpr std::size_t kGreen = 1;

// Returns the minimum deviation of light by an ice prism with this angle between two faces.
double LeastDeviationDeg(double prism_angle_deg, double index) {
  return 2.0 * std::asin(index * std::sin(0.5 * prism_angle_deg * kDegree)) / kDegree -
         prism_angle_deg;
}

// Returns the mean of a function of the direction, over all directions.
template <typename Function>
double MeanOverSphere(const Function& function) {
  constexpr int kSteps = 400;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double z = (i + 0.5) / kSteps * 2.0 - 1.0;
    for (int j = 0; j < kSteps; ++j) {
      const double azimuth = (j + 0.5) / kSteps * 2.0 * kPi;
      const double radius = std::sqrt(1.0 - z * z);
      sum += function(dvec3(radius * std::cos(azimuth), radius * std::sin(azimuth), z));
    }
  }
  return sum / (kSteps * kSteps);
}

double PeakAngleDeg(const PhaseTable& table, std::size_t channel, double from_deg, double to_deg) {
  double best_deg = from_deg;
  for (double angle_deg = from_deg; angle_deg <= to_deg; angle_deg += 0.05) {
    if (table.Value(angle_deg * kDegree, channel) > table.Value(best_deg * kDegree, channel)) {
      best_deg = angle_deg;
    }
  }
  return best_deg;
}

IceRecipe RecipeOf(const std::string& name) {
  for (const IceRecipe& recipe : IceRecipes()) {
    if (recipe.name == name) return recipe;
  }
  ADD_FAILURE() << name;
  return {};
}

PhaseTable SmallTable(const std::string& name) {
  IceRecipe recipe = RecipeOf(name);
  recipe.rays = 40'000;
  recipe.orientations = 400;
  return Build(recipe, {.threads = 2}).table;
}

TEST(Fresnel, KeepsEnergyAndFollowsSnell) {
  const dvec3 normal(0.0, 0.0, 1.0);
  for (const double ratio : {1.0 / 1.311, 1.311}) {
    for (double angle_deg = 0.0; angle_deg < 90.0; angle_deg += 7.0) {
      const double sine = std::sin(angle_deg * kDegree);
      const BoundaryRays rays =
          CrossBoundary(UnpolarizedRay({sine, 0.0, -std::cos(angle_deg * kDegree)}), normal, ratio);
      EXPECT_NEAR(rays.reflected.Energy() + rays.refracted.Energy(), 1.0, 1e-12);
      EXPECT_NEAR(rays.reflected.Energy(), Reflectance(std::cos(angle_deg * kDegree), ratio),
                  1e-12);
      EXPECT_EQ(rays.total_reflection, sine * ratio >= 1.0);
      if (rays.total_reflection) continue;
      EXPECT_NEAR(rays.refracted.direction.x, ratio * sine, 1e-12);
      // Fields stay perpendicular to the rays.
      EXPECT_NEAR(glm::dot(rays.refracted.fields[0].re, rays.refracted.direction), 0.0, 1e-12);
      EXPECT_NEAR(glm::dot(rays.reflected.fields[1].re, rays.reflected.direction), 0.0, 1e-12);
    }
  }
}

TEST(Fresnel, KnownReflectances) {
  EXPECT_NEAR(Reflectance(1.0, 1.0 / 1.5), 0.04, 1e-12);
  // At Brewster's angle only light polarised across the plane of incidence is reflected: half of
  // ((n^2 - 1) / (n^2 + 1))^2.
  const double n = 1.5;
  EXPECT_NEAR(Reflectance(1.0 / std::sqrt(1.0 + n * n), 1.0 / n),
              0.5 * std::pow((n * n - 1.0) / (n * n + 1.0), 2), 1e-12);
  EXPECT_NEAR(Reflectance(0.0, 1.0 / n), 1.0, 1e-12);
}

// Light reflected at Brewster's angle is polarised. A second reflection at the same angle, in a
// plane perpendicular to the first, extinguishes it.
TEST(Fresnel, CrossedBrewsterReflectionsExtinguish) {
  const double n = 1.5;
  const double tilt = std::atan(n);
  const BoundaryRays first = CrossBoundary(UnpolarizedRay({std::sin(tilt), 0.0, -std::cos(tilt)}),
                                           {0.0, 0.0, 1.0}, 1.0 / n);
  const dvec3 d = first.reflected.direction;
  const dvec3 normal = -std::cos(tilt) * d + std::sin(tilt) * dvec3(0.0, 1.0, 0.0);
  const BoundaryRays second = CrossBoundary(first.reflected, normal, 1.0 / n);
  EXPECT_GT(first.reflected.Energy(), 0.05);
  EXPECT_NEAR(second.reflected.Energy(), 0.0, 1e-12);
}

TEST(HexagonalPrism, ShadowsAverageToAQuarterOfTheSurface) {
  const HexagonalPrism prism(40.0, 100.0);
  double surface = 0.0;
  for (std::size_t face = 0; face < HexagonalPrism::kFaces; ++face) surface += prism.Area(face);
  const double mean =
      MeanOverSphere([&](const dvec3& direction) { return prism.ProjectedArea(direction); });
  EXPECT_NEAR(mean / (0.25 * surface), 1.0,
              1e-3);  // by Cauchy's theorem; the tolerance covers the midpoint quadrature
}

TEST(HexagonalPrism, PointsLieOnTheirFaces) {
  const HexagonalPrism prism(40.0, 100.0);
  for (std::size_t face = 0; face < HexagonalPrism::kFaces; ++face) {
    for (double u = 0.01; u < 1.0; u += 0.14) {
      for (double v = 0.01; v < 1.0; v += 0.14) {
        const dvec3 point = prism.PointOn(face, u, v);
        const HexagonalPrism::Exit exit =
            prism.ExitOf(point - 1e-6 * prism.Normal(face), prism.Normal(face));
        EXPECT_EQ(exit.face, face);
        EXPECT_NEAR(exit.distance, 1e-6, 1e-9);
      }
    }
  }
}

// A convex body in random orientations shows its faces at all angles equally. It therefore reflects
// like a sphere, the integral of 2 mu R(mu).
TEST(IceRays, OutsideReflectsLikeASphere) {
  const RayScattering rays = TraceRays({50, 80}, AngleGrid({{180, 1}}), 50'000, 7, {.threads = 2});
  for (std::size_t c = 0; c < kPhaseChannels; ++c) {
    const GaussLegendre gauss(40);
    double expected = 0.0;
    for (std::size_t i = 0; i < gauss.points.size(); ++i) {
      const double mu = 0.5 * (1.0 + gauss.points[i]);
      expected += gauss.weights[i] * mu * Reflectance(mu, 1.0 / kIceRefractiveIndex[c]);
    }
    EXPECT_NEAR(rays.budget.reflected[c], expected, 5e-4);
  }
}

TEST(IceRays, AllEnergyIsAccountedFor) {
  for (const double roughness : {0.0, 0.5}) {
    const RayScattering rays =
        TraceRays({50, 80, roughness}, AngleGrid({{180, 1}}), 20'000, 7, {.threads = 2});
    const RayBudget& budget = rays.budget;
    EXPECT_LT(budget.left[kGreen], 1e-4);
    EXPECT_NEAR(budget.reflected[kGreen] + budget.straight[kGreen] + budget.scattered[kGreen] +
                    budget.left[kGreen],
                1.0, 1e-12);
    // The weight of a ray is its crystal's shadow. By Cauchy's theorem the mean of the shadows is a
    // quarter of the surface.
    const double surface = 6.0 * 25.0 * 80.0 + 2.0 * 1.5 * std::numbers::sqrt3 * 25.0 * 25.0;
    const double traced = rays.light.energy()[kGreen] /
                          (budget.reflected[kGreen] + budget.scattered[kGreen]) / 20'000;
    EXPECT_NEAR(traced / (0.25 * surface), 1.0, 1e-3);
  }
}

TEST(IceRays, SameBitsOnAnyNumberOfThreads) {
  const std::vector<double> angles = AngleGrid({{180, 1}});
  const auto values = [&](int threads, std::uint64_t seed) {
    return TraceRays({50, 80, 0.3}, angles, 4000, seed, {.threads = threads}).light.Values();
  };
  EXPECT_EQ(values(1, 3), values(3, 3));
  EXPECT_NE(values(1, 3), values(1, 4));
}

TEST(IceDiffraction, CarriesTheShadowsEnergyAndItsSquareForward) {
  const IceCrystal crystal{50, 80};
  const HexagonalPrism prism(crystal.width_um, crystal.length_um);
  const std::vector<double> angles = AngleGrid({{0.1, 0.01}, {2, 0.1}, {10, 0.25}, {180, 1}});
  constexpr int kOrientations = 1000;
  const PhaseAccumulator light = Diffract(crystal, angles, kOrientations, 5, {.threads = 2});
  const double area = MeanOverSphere([&](const dvec3& d) { return prism.ProjectedArea(d); });
  const double square =
      MeanOverSphere([&](const dvec3& d) { return std::pow(prism.ProjectedArea(d), 2); });
  for (std::size_t c = 0; c < kPhaseChannels; ++c) {
    // One per cent of the energy is lost beyond 90 degrees and by the obliquity factor. Noise may
    // be another per cent.
    EXPECT_NEAR(light.energy()[c] / (kOrientations * area), 1.0, 0.02);
    // In the forward direction, the waves from all points of a shadow with the area A are in phase.
    // The diffracted light per steradian is k^2 A^2 / (4 pi^2). The phase function is the mean of
    // this over all orientations, multiplied by 4 pi and divided by the mean of A.
    const double k = 2.0 * kPi / kWavelengthsUm[c];
    EXPECT_NEAR(light.Values().front()[c] / (k * k / kPi * square / area), 1.0, 0.05);
  }
}

// Few rays show the sharp inner edges of the halos, but leave too much noise to locate their peaks.
TEST(IceRays, FewRaysHaveHalosFromLeastDeviation) {
  const std::vector<double> angles = AngleGrid({{20, 1}, {50, 0.5}, {180, 2}});
  for (const char* name : {"ice_columns", "ice_plates"}) {
    const RayScattering rays = TraceRays(RecipeOf(name).crystal, angles, 60'000, 1, {.threads = 2});
    const auto table =
        PhaseTable::Create({name, kWavelengthsUm, angles, rays.light.Values()}, 1e-9);
    ASSERT_TRUE(table.ok()) << table.status();
    for (std::size_t c = 0; c < kPhaseChannels; ++c) {
      for (const auto& [prism_deg, rise] : {std::pair{60.0, 5.0}, {90.0, 1.4}}) {
        const double edge_deg = LeastDeviationDeg(prism_deg, kIceRefractiveIndex[c]);
        EXPECT_GT(table->Value((edge_deg + 0.6) * kDegree, c),
                  rise * table->Value((edge_deg - 0.6) * kDegree, c))
            << name << " " << edge_deg;
      }
    }
  }
}

TEST(IceTables, SmallRunsAgreeWithTheFiles) {
  for (const char* name : {"ice_columns", "ice_plates", "ice_rough"}) {
    const PhaseTable small = SmallTable(name);
    const auto file = EmbeddedPhaseTable(name);
    ASSERT_TRUE(file.ok()) << file.status();
    for (std::size_t c = 0; c < kPhaseChannels; ++c) {
      EXPECT_NEAR(small.Asymmetry(c), file->Asymmetry(c), 0.003) << name;
      for (const double angle_deg : {0.3, 1.0, 5.0, 21.0, 24.0, 45.0, 50.0, 90.0, 130.0, 170.0}) {
        // With only 400 crystal orientations the diffraction peak has a noise of one per cent.
        EXPECT_NEAR(small.CumulativeShare(angle_deg * kDegree, c),
                    file->CumulativeShare(angle_deg * kDegree, c), 0.01)
            << name << " " << angle_deg;
      }
    }
  }
}

TEST(IceTables, PristineCrystalsHaveHalosWithRedInside) {
  for (const char* name : {"ice_columns", "ice_plates"}) {
    const auto table = EmbeddedPhaseTable(name);
    ASSERT_TRUE(table.ok()) << table.status();
    for (const auto& [from_deg, to_deg, prism_deg] :
         {std::array{20.0, 30.0, 60.0}, std::array{43.0, 50.0, 90.0}}) {
      double previous_deg = 0.0;
      for (std::size_t c = 0; c < kPhaseChannels; ++c) {
        const double peak_deg = PeakAngleDeg(*table, c, from_deg, to_deg);
        // The halo's sharp inner edge is blurred by the sun's disc. The halo is brightest at one
        // solar radius outside this edge.
        const double disc_deg = kSunRadius_rad / kDegree;
        EXPECT_NEAR(peak_deg, LeastDeviationDeg(prism_deg, kIceRefractiveIndex[c]) + disc_deg, 0.5)
            << name;
        EXPECT_GT(peak_deg, previous_deg) << name;
        previous_deg = peak_deg;
        // For a halo, the peak must be far brighter than the dark region inside the ring.
        const double inside = table->Value((peak_deg - 1.5) * kDegree, c);
        EXPECT_GT(table->Value(peak_deg * kDegree, c), 1.8 * inside) << name;
      }
    }
    EXPECT_GT(table->Asymmetry(kGreen), 0.75) << name;
    EXPECT_LT(table->Asymmetry(kGreen), 0.825) << name;
  }
}

TEST(IceTables, RoughCrystalsHaveNone) {
  const auto table = EmbeddedPhaseTable("ice_rough");
  ASSERT_TRUE(table.ok()) << table.status();
  for (std::size_t c = 0; c < kPhaseChannels; ++c) {
    EXPECT_GT(table->Asymmetry(c), 0.76);
    EXPECT_LT(table->Asymmetry(c), 0.81);
    for (double angle_deg = 10.0; angle_deg < 60.0; angle_deg += 0.5) {
      // The curve falls smoothly: no value is above the mean of its neighbours at 1.5 degrees.
      const double around = 0.5 * (table->Value((angle_deg - 1.5) * kDegree, c) +
                                   table->Value((angle_deg + 1.5) * kDegree, c));
      EXPECT_NEAR(table->Value(angle_deg * kDegree, c) / around, 1.0, 0.05) << angle_deg;
    }
  }
}

}  // namespace
}  // namespace thunderhead::physics
