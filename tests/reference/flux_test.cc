// Tests of slabs with published answers: test 3 of the DISORT package, and van de Hulst's tables
// (Multiple light scattering, 1980) for albedo 0.9. They are followed by laws that must hold in any
// medium.
#include "reference/flux.h"

#include <array>
#include <cmath>
#include <numbers>
#include <stop_token>
#include <vector>

#include "comparisons.h"
#include "reference/path_radiance.h"
#include "reference/tracking.h"

namespace thunderhead::reference {
namespace {

constexpr double kRounding = 5e-6;  // of figures printed with five decimals

FluxResult Flux(const FluxProblem& problem, std::int64_t photons) {
  FluxOptions options;
  options.photons = photons;
  options.seed = 2026;
  auto result = ComputeFlux(problem, options, {}, {});
  EXPECT_TRUE(result.ok()) << result.status();
  return *result;
}

FluxResult Flux(std::shared_ptr<const Medium> medium, double zenith_deg, std::int64_t photons) {
  return Flux(FluxProblem::Of(std::move(medium), SunAt(zenith_deg)), photons);
}

// Every photon ends in exactly one place: the shares add up to 1.
void ExpectBalance(const FluxResult& result) {
  EXPECT_NEAR(result.reflectance.value + result.absorptance.value + result.sides.value +
                  result.ground_absorptance.value,
              1.0, 1e-12);
  EXPECT_NEAR(result.transmittance.value,
              result.transmittance_direct.value + result.transmittance_diffuse.value, 1e-12);
}

TEST(FluxSlab, DisortTest3Thin) {
  const FluxResult result = Flux(Slab(1.0, 0.75, 1.0), 0.0, 2'000'000);
  ExpectAgrees(result.reflectance, 0.07874, kRounding, 3e-4);
  ExpectAgrees(result.transmittance_diffuse, 0.55338, kRounding, 5e-4);
  ExpectAgrees(result.transmittance_direct, std::exp(-1.0), 0.0, 5e-4);
  ExpectBalance(result);
}

TEST(FluxSlab, DisortTest3Thick) {
  const FluxResult result = Flux(Slab(8.0, 0.75, 1.0), 0.0, 1'000'000);
  ExpectAgrees(result.reflectance, 0.50642, kRounding, 6e-4);
  ExpectAgrees(result.transmittance_diffuse, 0.49325, kRounding, 6e-4);
  ExpectAgrees(result.transmittance_direct, std::exp(-8.0), 0.0, 1e-4);
  EXPECT_EQ(result.absorptance.value, 0.0);
  ExpectBalance(result);
}

TEST(FluxSlab, VanDeHulst) {
  const FluxResult result = Flux(Slab(2.0, 0.75, 0.9), 0.0, 2'000'000);
  ExpectAgrees(result.reflectance, 0.09739, kRounding, 3e-4);
  ExpectAgrees(result.transmittance, 0.66096, kRounding, 5e-4);
  ExpectBalance(result);
}

// Returns Chandrasekhar's H function for isotropic scattering of the given albedo. It iterates 1 /
// H = sqrt(1 - w) + (w / 2) integral of H(m) m / (mu + m).
double ChandrasekharH(double albedo, double at_mu) {
  constexpr int kNodes = 2000;
  std::vector<double> h(kNodes, 1.0);
  const auto value = [&](double mu) {
    double sum = 0.0;
    for (int i = 0; i < kNodes; ++i) {
      const double m = (i + 0.5) / kNodes;
      sum += h[static_cast<std::size_t>(i)] * m / (mu + m) / kNodes;
    }
    return 1.0 / (std::sqrt(1.0 - albedo) + 0.5 * albedo * sum);
  };
  for (int iteration = 0; iteration < 40; ++iteration) {
    std::vector<double> next;
    for (int i = 0; i < kNodes; ++i) next.push_back(value((i + 0.5) / kNodes));
    h = std::move(next);
  }
  return value(at_mu);
}

// The plane albedo of a semi-infinite isotropic atmosphere is exactly 1 - sqrt(1 - w) H(mu0), here
// for a sun at 60 and at 80 degrees. Nothing returns from beyond optical depth 40 (exp(-0.53 * 2 *
// 40)).
TEST(FluxSlab, DeepIsotropicAtmosphereUnderLowSun) {
  constexpr double kAlbedo = 0.9;
  const auto medium = Slab(40.0, 0.0, kAlbedo);
  for (const double zenith_deg : {60.0, 80.0}) {
    const double mu0 = SunAt(zenith_deg).z;
    const FluxResult result = Flux(medium, zenith_deg, 500'000);
    ExpectAgrees(result.reflectance, 1.0 - std::sqrt(1.0 - kAlbedo) * ChandrasekharH(kAlbedo, mu0),
                 1e-5, 1e-3);
    ExpectBalance(result);
  }
}

// In the thin limit a slab reflects only single scattering: w tau / mu0 times the share of the
// phase function that points up. Twice scattered light is of relative order tau / mu0 = 2e-3.
TEST(FluxSlab, ThinLimitIsSingleScattering) {
  constexpr double kOpticalDepth = 1e-3;
  const FluxResult result = Flux(Slab(kOpticalDepth, 0.0, 0.8), 60.0, 8'000'000);
  const double once = 0.8 * kOpticalDepth / 0.5;
  ExpectAgrees(result.reflectance, 0.5 * once, 5e-3 * once, 1.5e-5);
  ExpectAgrees(result.transmittance_diffuse, 0.5 * once, 5e-3 * once, 1.5e-5);
  ExpectAgrees(result.absorptance, 0.2 * kOpticalDepth / 0.5, 5e-3 * once, 1.5e-5);
}

// Returns 2 E3(tau), the transmittance of an absorbing slab for diffuse light.
double DiffuseTransmittance(double optical_depth) {
  constexpr int kSteps = 100000;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double mu = (i + 0.5) / kSteps;
    sum += 2.0 * mu * std::exp(-optical_depth / mu) / kSteps;
  }
  return sum;
}

TEST(FluxGround, AbsorbingSlabOverLambertianGround) {
  FluxProblem problem = FluxProblem::Of(Slab(0.5, 0.0, 0.0), SunAt(60.0));
  problem.ground_albedo = 0.6;
  const FluxResult result = Flux(problem, 1'000'000);
  const double arrives = std::exp(-0.5 / 0.5);
  ExpectAgrees(result.transmittance_direct, arrives, 0.0, 6e-4);
  ExpectAgrees(result.ground_absorptance, 0.4 * arrives, 0.0, 6e-4);
  ExpectAgrees(result.reflectance, 0.6 * arrives * DiffuseTransmittance(0.5), 1e-8, 6e-4);
  ExpectBalance(result);
}

TEST(FluxGround, WhiteGroundUnderWhiteCloudReflectsAll) {
  FluxProblem problem = FluxProblem::Of(Made(Chessboard(0.008, 0.072, 1.0, 0.85)), SunAt(60.0));
  problem.ground_albedo = 1.0;
  const FluxResult result = Flux(problem, 20'000);
  EXPECT_EQ(result.reflectance.value, 1.0);
  EXPECT_GT(result.transmittance.value, 0.5);
}

TEST(FluxGround, EmptySkyShowsTheGround) {
  MediumDescription nothing = EmptyDescription({2, 2, 2}, {100.0, 100.0, 100.0});
  nothing.sides = Sides::kPeriodic;
  FluxProblem problem = FluxProblem::Of(Made(nothing), SunAt(70.0));
  problem.ground_albedo = 0.3;
  const FluxResult result = Flux(problem, 200'000);
  ExpectAgrees(result.reflectance, 0.3, 0.0, 2e-3);
  EXPECT_EQ(result.transmittance_direct.value, 1.0);
  EXPECT_EQ(result.transmittance_diffuse.value, 0.0);
}

// A black box 1 km tall and 4 km wide under a sun at 60 degrees. The beam leaves through a side
// where it enters less than tan(60 degrees) km from that side.
TEST(FluxOpenSides, AbsorbingBoxUnderLowSun) {
  MediumDescription box = EmptyDescription({4, 3, 2}, {1000.0, 1000.0, 500.0});
  constexpr double kExtinction_per_km = 0.7;
  box.groups.push_back(
      {std::vector<float>(24, 0.7e-3F), glm::dvec3(0.0), HenyeyGreensteinPhase(0.0)});
  const FluxResult result = Flux(Made(box), 60.0, 1'000'000);
  const double sine = std::sqrt(0.75);
  const double reach_km = std::sqrt(3.0);
  ExpectAgrees(result.transmittance, (4.0 - reach_km) / 4.0 * std::exp(-kExtinction_per_km / 0.5),
               0.0, 5e-4);
  ExpectAgrees(
      result.sides,
      sine / (4.0 * kExtinction_per_km) * (1.0 - std::exp(-kExtinction_per_km * reach_km / sine)),
      0.0, 5e-4);
  EXPECT_EQ(result.reflectance.value, 0.0);
  ExpectBalance(result);
}

// The same box in a wider and taller domain: sunlight falls on the domain's top.
TEST(FluxOpenSides, DomainLargerThanTheMedium) {
  MediumDescription box = EmptyDescription({1, 1, 1}, {1000.0, 1000.0, 1000.0});
  box.groups.push_back({{0.1F}, glm::dvec3(0.0), HenyeyGreensteinPhase(0.0)});
  FluxProblem problem = FluxProblem::Of(Made(box), SunAt(45.0));
  problem.domain_low_m -= glm::dvec3(3000.0, 1000.0, 0.0);
  problem.domain_high_m += glm::dvec3(3000.0, 1000.0, 500.0);
  const FluxResult result = Flux(problem, 400'000);
  // The box (optical depth 100) stops the light that falls on its top and on its sunlit wall.
  // Projected onto the plane of the domain's top, these two measure 2 x 1 km together. The top
  // measures 7 x 3 km.
  ExpectAgrees(result.absorptance, 2.0 * 1.0 / 21.0, 1e-4, 1e-3);
  ExpectBalance(result);
}

// Returns the optical depth from x = 0 eastwards along a row of the chessboard, per metre of path.
double DepthUpTo(double x_m, double low_per_m, double high_per_m) {
  const double columns = std::floor(x_m / 500.0);
  const double pairs = std::floor(columns / 2.0);
  const double first = columns - 2.0 * pairs;
  const double rest_m = x_m - 500.0 * columns;
  return pairs * 500.0 * (low_per_m + high_per_m) +
         (first > 0.0 ? 500.0 * low_per_m + rest_m * high_per_m : rest_m * low_per_m);
}

// Compares the direct beam with exact optical paths through steep walls, in a periodic domain under
// a low sun. For a sun at 60 degrees the beam drifts 433 m in the 250 m of height.
TEST(FluxSteepWalls, DirectBeamAt60Degrees) {
  const double low_per_m = 2.0 / 250.0 / 4.0;
  const double high_per_m = 18.0 / 250.0 / 4.0;
  const FluxResult result =
      Flux(Made(Chessboard(low_per_m, high_per_m, 1.0, 0.85)), 60.0, 1'000'000);
  const double drift_m = 250.0 * std::sqrt(3.0);
  double expected = 0.0;
  constexpr int kSteps = 100000;
  for (int i = 0; i < kSteps; ++i) {
    const double x_m = 1000.0 * (i + 0.5) / kSteps;
    const double across =
        DepthUpTo(x_m + drift_m, low_per_m, high_per_m) - DepthUpTo(x_m, low_per_m, high_per_m);
    expected += std::exp(-across / std::sqrt(0.75)) / kSteps;
  }
  ExpectAgrees(result.transmittance_direct, expected, 1e-6, 5e-4);
  EXPECT_EQ(result.sides.value, 0.0);
  EXPECT_EQ(result.absorptance.value, 0.0);
  ExpectBalance(result);
}

// Returns the irradiance through a horizontal plane, by paths traced backwards, over the sunlight
// on the top.
FluxShare BackwardShare(const Medium& medium, const glm::dvec3& towards_sun, bool at_top) {
  Surroundings around;
  around.towards_sun = towards_sun;
  around.sun_irradiance = glm::dvec3(1.0);
  const glm::dvec3 size = medium.High_m() - medium.Low_m();
  SampleMean mean;
  for (std::uint64_t i = 0; i < 150000; ++i) {
    RandomStream random(7, i, at_top ? 1 : 2);
    Ray ray;
    ray.origin_m =
        medium.Low_m() + size * glm::dvec3(random.Uniform(), random.Uniform(), at_top ? 1.0 : 0.0);
    ray.direction = SampleCosine({0.0, 0.0, at_top ? -1.0 : 1.0}, &random);
    const double radiance = EstimateRadiance(medium, around, ray, &random).radiance.x;
    mean.Add(std::numbers::pi * radiance / towards_sun.z);
  }
  return mean.Share();
}

// Photons from the sun and paths from the detector share no estimator. They must agree on a step
// cloud (optical depth 2 and 18) under a sun at 60 degrees, with and without absorption.
TEST(FluxSteepWalls, ForwardAgreesWithBackward) {
  for (const double albedo : {1.0, 0.95}) {
    SCOPED_TRACE(albedo);
    const auto medium = Made(Chessboard(2.0 / 250.0, 18.0 / 250.0, albedo, 0.7));
    const glm::dvec3 towards_sun = SunAt(60.0);
    const FluxResult forward = Flux(medium, 60.0, 400'000);
    ExpectBalance(forward);
    ExpectAgree(forward.reflectance, BackwardShare(*medium, towards_sun, true), 6e-3);
    ExpectAgree(forward.transmittance_diffuse, BackwardShare(*medium, towards_sun, false), 6e-3);
  }
}

// Makes the same comparison for a lumpy cloud that varies linearly between cells.
TEST(FluxPeriodic, ForwardAgreesWithBackward) {
  MediumDescription cloud = LumpyCloud(0.04, 1.0, 0.7);
  cloud.sides = Sides::kPeriodic;
  const auto medium = Made(cloud);
  const FluxResult forward = Flux(medium, 60.0, 400'000);
  ExpectAgree(forward.reflectance, BackwardShare(*medium, SunAt(60.0), true), 6e-3);
  ExpectAgree(forward.transmittance_diffuse, BackwardShare(*medium, SunAt(60.0), false), 6e-3);
}

// Compares two groups with one group of the mixed phase function and albedo.
TEST(FluxGroups, MixtureIsTheWeightedMean) {
  MediumDescription two = Chessboard(0.002, 0.018, 1.0, 0.8);
  two.groups.push_back(two.groups[0]);
  two.groups[1].albedo = glm::dvec3(0.7);
  two.groups[1].phase = HenyeyGreensteinPhase(-0.2);
  MediumDescription one = Chessboard(0.004, 0.036, 0.85, 0.8);
  const SampledPhase forward = SampledPhase::HenyeyGreenstein(0.8);
  const SampledPhase backward = SampledPhase::HenyeyGreenstein(-0.2);
  one.groups[0].phase = std::make_shared<const SampledPhase>(SampledPhase::Tabulated(
      [&](double mu) { return (forward.Value(mu).x + 0.7 * backward.Value(mu).x) / 1.7; }));
  const FluxResult by_two = Flux(Made(two), 60.0, 500'000);
  const FluxResult by_one = Flux(Made(one), 60.0, 500'000);
  ExpectAgree(by_two.reflectance, by_one.reflectance, 2e-3);
  ExpectAgree(by_two.transmittance, by_one.transmittance, 2e-3);
  ExpectAgree(by_two.absorptance, by_one.absorptance, 2e-3);
}

TEST(Flux, SameForAnyNumberOfThreads) {
  FluxProblem problem = FluxProblem::Of(Made(LumpyCloud(0.05, 0.95, 0.8)), SunAt(60.0));
  problem.ground_albedo = 0.4;
  FluxOptions options;
  options.photons = 30'001;
  std::vector<FluxResult> results;
  for (const int threads : {1, 2, 5}) {
    options.threads = threads;
    results.push_back(*ComputeFlux(problem, options, {}, {}));
  }
  for (const FluxResult& result : results) {
    EXPECT_EQ(result.photons, 30'001);
    EXPECT_EQ(result.reflectance.value, results[0].reflectance.value);
    EXPECT_EQ(result.reflectance.standard_error, results[0].reflectance.standard_error);
    EXPECT_EQ(result.transmittance.standard_error, results[0].transmittance.standard_error);
    EXPECT_EQ(result.absorptance.value, results[0].absorptance.value);
    EXPECT_EQ(result.sides.value, results[0].sides.value);
    EXPECT_EQ(result.transmittance_direct.value, results[0].transmittance_direct.value);
  }
}

// The standard deviation of 400 runs with different seeds must match the standard error that they
// report. The sum of squared deviations over squared errors is chi-squared, so it must lie within 4
// of its standard deviations.
TEST(Flux, StandardErrorsAreHonest) {
  FluxProblem problem = FluxProblem::Of(Slab(2.0, 0.75, 0.9), SunAt(60.0));
  problem.ground_albedo = 0.5;
  constexpr int kRuns = 400;
  SampleMean mean;
  std::vector<FluxShare> shares;
  FluxOptions options;
  options.photons = 1000;
  for (int run = 0; run < kRuns; ++run) {
    options.seed = static_cast<std::uint64_t>(run);
    shares.push_back(ComputeFlux(problem, options, {}, {})->transmittance);
    mean.Add(shares.back().value);
  }
  double chi_squared = 0.0;
  for (const FluxShare& share : shares) {
    const double z = (share.value - mean.Share().value) / share.standard_error;
    chi_squared += z * z;
  }
  EXPECT_NEAR(chi_squared / kRuns, 1.0, 4.0 * std::sqrt(2.0 / kRuns));
}

TEST(Flux, Extremes) {
  for (const double optical_depth : {0.0, 1e-8, 1e-4, 1.0, 1e2, 1e4}) {
    for (const double albedo : {0.0, 0.5, 1.0}) {
      for (const double zenith_deg : {0.0, 60.0, 89.9}) {
        SCOPED_TRACE(testing::Message() << optical_depth << " " << albedo << " " << zenith_deg);
        const bool slow = optical_depth > 1e3 && albedo == 1.0;
        const FluxResult result =
            Flux(Slab(optical_depth, 0.85, albedo), zenith_deg, slow ? 300 : 3000);
        ExpectBalance(result);
        for (const FluxShare& share : {result.reflectance, result.transmittance, result.absorptance,
                                       result.ground_absorptance}) {
          EXPECT_GE(share.value, 0.0);
          EXPECT_LE(share.value, 1.0);
          EXPECT_TRUE(std::isfinite(share.standard_error));
        }
      }
    }
  }
  EXPECT_EQ(Flux(Slab(0.0, 0.85, 1.0), 60.0, 1000).transmittance_direct.value, 1.0);
  EXPECT_GT(Flux(Slab(1e4, 0.85, 1.0), 60.0, 300).reflectance.value, 0.98);
}

TEST(Flux, StopsWhenAsked) {
  std::stop_source stop;
  FluxOptions options;
  options.photons = std::int64_t{1} << 40;
  int rounds = 0;
  const auto result = ComputeFlux(
      FluxProblem::Of(Slab(1.0, 0.75, 1.0), SunAt(0.0)), options,
      [&](double share) {
        EXPECT_LT(share, 1e-3);
        if (++rounds == 2) stop.request_stop();
      },
      stop.get_token());
  ASSERT_TRUE(result.ok());
  EXPECT_GT(result->photons, 0);
  EXPECT_LT(result->photons, std::int64_t{1} << 20);
  ExpectBalance(*result);
  EXPECT_EQ(
      ComputeFlux(FluxProblem::Of(Slab(1.0, 0.75, 1.0), SunAt(0.0)), options, {}, stop.get_token())
          .status()
          .code(),
      absl::StatusCode::kCancelled);
}

TEST(Flux, StopsAfterTheTimeGiven) {
  FluxOptions options;
  options.photons = std::int64_t{1} << 40;
  options.seconds = 1e-6;
  const auto result =
      ComputeFlux(FluxProblem::Of(Slab(1.0, 0.75, 1.0), SunAt(0.0)), options, {}, {});
  ASSERT_TRUE(result.ok());
  EXPECT_GT(result->photons, 0);
}

TEST(Flux, RefusesImpossibleProblems) {
  const auto code_of = [](const FluxProblem& problem, const FluxOptions& options) {
    return ComputeFlux(problem, options, {}, {}).status().code();
  };
  const FluxProblem good = FluxProblem::Of(Slab(1.0, 0.75, 1.0), SunAt(0.0));
  FluxProblem problem = good;
  problem.towards_sun = {1.0, 0.0, 0.0};
  EXPECT_EQ(code_of(problem, {}), absl::StatusCode::kInvalidArgument);
  problem = good;
  problem.ground_albedo = 1.2;
  EXPECT_EQ(code_of(problem, {}), absl::StatusCode::kInvalidArgument);
  problem = good;
  problem.domain_high_m.z -= 1.0;
  EXPECT_EQ(code_of(problem, {}), absl::StatusCode::kInvalidArgument);
  problem = FluxProblem::Of(Made(Chessboard(0.01, 0.02, 1.0, 0.0)), SunAt(0.0));
  problem.domain_high_m.x += 250.0;
  EXPECT_EQ(code_of(problem, {}), absl::StatusCode::kInvalidArgument);
  FluxOptions none;
  none.photons = 0;
  EXPECT_EQ(code_of(good, none), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace thunderhead::reference
