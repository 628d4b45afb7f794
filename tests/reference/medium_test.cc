#include "reference/medium.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "comparisons.h"
#include "glm/geometric.hpp"
#include "reference/brick_walk.h"
#include "reference/tracking.h"

namespace thunderhead::reference {
namespace {

constexpr double kNoLimit_m = std::numeric_limits<double>::infinity();

MediumDescription TwoCells(Interpolation interpolation, Sides sides) {
  MediumDescription two = EmptyDescription({2, 1, 1}, {10.0, 10.0, 10.0});
  two.interpolation = interpolation;
  two.sides = sides;
  two.groups.push_back({{1.0F, 3.0F}, glm::dvec3(1.0), HenyeyGreensteinPhase(0.0)});
  return two;
}

double At(const Medium& medium, double east_of_corner_m) {
  return medium.Extinction_per_m(medium.Low_m() + glm::dvec3(east_of_corner_m, 4.0, 7.0));
}

TEST(Medium, LinearBetweenCentresAndHeldBeyondThem) {
  const auto medium = Made(TwoCells(Interpolation::kLinear, Sides::kOpen));
  EXPECT_DOUBLE_EQ(At(*medium, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(At(*medium, 5.0), 1.0);
  EXPECT_DOUBLE_EQ(At(*medium, 7.5), 1.5);
  EXPECT_DOUBLE_EQ(At(*medium, 15.0), 3.0);
  EXPECT_DOUBLE_EQ(At(*medium, 20.0), 3.0);
}

TEST(Medium, PeriodicWrapsAround) {
  const auto medium = Made(TwoCells(Interpolation::kLinear, Sides::kPeriodic));
  EXPECT_DOUBLE_EQ(At(*medium, 0.0), 2.0);
  EXPECT_DOUBLE_EQ(At(*medium, 20.0), 2.0);
  EXPECT_NEAR(At(*medium, 17.0), 2.6, 1e-12);
  EXPECT_NEAR(At(*medium, 57.0), 2.6, 1e-12);
  EXPECT_NEAR(At(*medium, -23.0), 2.6, 1e-12);
}

TEST(Medium, ConstantInsideCells) {
  const auto medium = Made(TwoCells(Interpolation::kConstant, Sides::kOpen));
  EXPECT_DOUBLE_EQ(At(*medium, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(At(*medium, 9.99), 1.0);
  EXPECT_DOUBLE_EQ(At(*medium, 10.01), 3.0);
  EXPECT_DOUBLE_EQ(At(*medium, 20.0), 3.0);
}

TEST(Medium, RefusesWhatIsNoExtinction) {
  for (const float bad : {-1e-6F, NAN, INFINITY}) {
    MediumDescription two = TwoCells(Interpolation::kLinear, Sides::kOpen);
    two.groups[0].extinction_per_m[1] = bad;
    EXPECT_EQ(Medium::Create(two).status().code(), absl::StatusCode::kInvalidArgument) << bad;
  }
  MediumDescription short_by_one = TwoCells(Interpolation::kLinear, Sides::kOpen);
  short_by_one.groups[0].extinction_per_m.pop_back();
  EXPECT_FALSE(Medium::Create(short_by_one).ok());
  MediumDescription bright = TwoCells(Interpolation::kLinear, Sides::kOpen);
  bright.groups[0].albedo.y = 1.01;
  EXPECT_FALSE(Medium::Create(bright).ok());
}

// Each group's expected scattering and its share of the phase function must be those of the
// mixture.
TEST(Medium, GroupsAreChosenByTheirScattering) {
  MediumDescription mixed = EmptyDescription({1, 1, 1}, {10.0, 10.0, 10.0});
  const auto forward = HenyeyGreensteinPhase(0.8);
  const auto backward = HenyeyGreensteinPhase(-0.5);
  mixed.groups.push_back({{2.0F}, {0.9, 0.9, 0.3}, forward});
  mixed.groups.push_back({{6.0F}, {0.2, 0.8, 0.2}, backward});
  const auto medium = Made(mixed);
  glm::dvec3 forward_share(0.0);
  glm::dvec3 backward_share(0.0);
  constexpr int kSamples = 100000;
  for (int i = 0; i < kSamples; ++i) {
    const Scattering scattering = medium->ScatteringAt(medium->Low_m() + 5.0, (i + 0.5) / kSamples);
    (scattering.phase == forward.get() ? forward_share : backward_share) +=
        scattering.weight / static_cast<double>(kSamples);
  }
  for (int color = 0; color < 3; ++color) {
    EXPECT_NEAR(forward_share[color], 0.25 * mixed.groups[0].albedo[color], 1e-4);
    EXPECT_NEAR(backward_share[color], 0.75 * mixed.groups[1].albedo[color], 1e-4);
  }
}

// The similar medium (reference/medium.h) scatters light less often than the exact one, but
// deflects and absorbs it as much.
TEST(Medium, TheSimilarOneTurnsAndAbsorbsAsMuch) {
  MediumDescription mixed = EmptyDescription({1, 1, 1}, {10.0, 10.0, 10.0});
  mixed.groups.push_back({{2.0F}, glm::dvec3(0.9), HenyeyGreensteinPhase(0.8)});
  mixed.groups.push_back({{6.0F}, glm::dvec3(0.5), HenyeyGreensteinPhase(-0.5)});
  mixed.similar = true;
  const auto medium = Made(mixed);
  const glm::dvec3 middle_m = medium->Low_m() + 5.0;
  // The second group scatters backwards, so it keeps its extinction of 6 per metre.
  const double forward_per_m = 2.0 * (1.0 - 0.9 * 0.64);
  EXPECT_NEAR(medium->Extinction_per_m(middle_m, Optics::kSimilar), forward_per_m + 6.0, 1e-6);
  EXPECT_NEAR(medium->Majorant_per_m({0, 0, 0}, Optics::kSimilar), forward_per_m + 6.0, 1e-4);
  double scattered = 0.0;
  double turned = 0.0;
  constexpr int kSamples = 100000;
  for (int i = 0; i < kSamples; ++i) {
    const Scattering scattering =
        medium->ScatteringAt(middle_m, (i + 0.5) / kSamples, Optics::kSimilar);
    scattered += scattering.weight.y / kSamples;
    turned += scattering.weight.y * (1.0 - scattering.phase->Asymmetry()) / kSamples;
  }
  const double absorbed_per_m = 2.0 * (1.0 - 0.9) + 6.0 * (1.0 - 0.5);
  EXPECT_NEAR((forward_per_m + 6.0) * (1.0 - scattered), absorbed_per_m, 1e-4);
  const double turned_per_m = 2.0 * 0.9 * (1.0 - 0.8) + 6.0 * 0.5 * (1.0 + 0.5);
  EXPECT_NEAR((forward_per_m + 6.0) * turned, turned_per_m, 1e-4);
}

// The similar medium has one extinction for all colours: the brightest colour keeps its albedo.
TEST(Medium, AColoredOneStaysAsBright) {
  MediumDescription red = EmptyDescription({1, 1, 1}, {10.0, 10.0, 10.0});
  red.groups.push_back({{2.0F}, {1.0, 0.5, 0.0}, HenyeyGreensteinPhase(0.8)});
  red.similar = true;
  const auto medium = Made(red);
  const Scattering scattering = medium->ScatteringAt(medium->Low_m() + 5.0, 0.5, Optics::kSimilar);
  EXPECT_NEAR(scattering.weight.x, 1.0, 1e-12);
  EXPECT_NEAR(scattering.weight.y, 0.5, 1e-12);
  EXPECT_EQ(scattering.weight.z, 0.0);
}

Ray RandomRay(const Medium& medium, RandomStream* random) {
  const glm::dvec3 size = medium.High_m() - medium.Low_m();
  const glm::dvec3 place(random->Uniform(), random->Uniform(), random->Uniform());
  const double mu = 2.0 * random->Uniform() - 1.0;
  const glm::dvec3 direction = Deflect({0.0, 0.0, 1.0}, mu, 6.3 * random->Uniform());
  // The ray starts inside or outside the box.
  return {medium.Low_m() + (2.0 * place - 0.5) * size, direction};
}

struct Case {
  const char* name;
  MediumDescription description;
};

// Returns media of linear and of constant cells, one whose box cuts cells, and a periodic one.
std::vector<Case> Cases() {
  std::vector<Case> cases;
  cases.push_back({"linear", LumpyCloud(0.02, 1.0, 0.5)});
  cases.push_back({"constant", LumpyCloud(0.02, 1.0, 0.5)});
  cases.back().description.interpolation = Interpolation::kConstant;
  cases.push_back({"cut", LumpyCloud(0.02, 1.0, 0.5)});
  cases.back().description.low_m += glm::dvec3(50.0, 65.0, 35.0);
  cases.back().description.high_m -= glm::dvec3(50.0, 65.0, 35.0);
  cases.push_back({"periodic", LumpyCloud(0.02, 1.0, 0.5)});
  cases.back().description.sides = Sides::kPeriodic;
  cases.push_back({"chessboard", Chessboard(0.0, 0.02, 1.0, 0.5)});
  // The domain is one cell thick, with condensate at all sides and two groups.
  cases.push_back({"thin", EmptyDescription({5, 1, 4}, {100.0, 200.0, 70.0})});
  ScatteringGroup thick{std::vector<float>(20, 0.008F), glm::dvec3(1.0),
                        HenyeyGreensteinPhase(0.5)};
  ScatteringGroup other{{}, glm::dvec3(1.0), HenyeyGreensteinPhase(0.5)};
  for (int i = 0; i < 20; ++i) other.extinction_per_m.push_back(static_cast<float>(i % 3) * 0.006F);
  cases.back().description.groups = {thick, other};
  for (Case& test : cases) test.description.similar = true;
  return cases;
}

class MediumWith : public testing::TestWithParam<Optics> {};
INSTANTIATE_TEST_SUITE_P(Optics, MediumWith, testing::Values(Optics::kExact, Optics::kSimilar),
                         [](const auto& with) {
                           return with.param == Optics::kExact ? "Exact" : "Similar";
                         });

// Along random rays, segments must not overlap. Extinction must be at most the segment's majorant,
// and zero outside of segments.
TEST_P(MediumWith, StretchesBoundExtinction) {
  // No cell has a larger extinction, so a larger majorant would not be tight.
  const double largest_per_m = GetParam() == Optics::kExact ? 0.02 : 0.75 * 0.02;
  for (const Case& test : Cases()) {
    SCOPED_TRACE(test.name);
    const auto medium = Made(test.description);
    RandomStream random(3, 0, 0);
    int bounded = 0;
    for (int i = 0; i < 300; ++i) {
      const Ray ray = RandomRay(*medium, &random);
      const RayInterval interval = Clip(*medium, ray, 5000.0);
      BrickWalk walk(*medium, ray, 5000.0, GetParam());
      Stretch stretch{interval.begin_m, interval.begin_m, 0.0};
      bool more = interval.begin_m < interval.end_m;
      for (int k = 0; more && k < 400; ++k) {
        const double at_m =
            interval.begin_m + (k + 0.5) / 400 * (interval.end_m - interval.begin_m);
        while (more && stretch.end_m < at_m) {
          const double end_m = stretch.end_m;
          more = walk.Next(&stretch);
          if (more) {
            ASSERT_GE(stretch.begin_m, end_m - 1e-9);
          }
        }
        const double extinction = medium->Extinction_per_m(ray.At(at_m), GetParam());
        const bool within = more && at_m >= stretch.begin_m;
        ASSERT_LE(extinction, within ? stretch.majorant_per_m : 1e-12) << i << " at " << at_m;
        ASSERT_LE(within ? stretch.majorant_per_m : 0.0, 1.005 * largest_per_m);
        bounded += extinction > 0.0 ? 1 : 0;
      }
    }
    EXPECT_GT(bounded, 10'000) << "rays meet the medium";
  }
}

double DepthWithin(const Medium& medium, const Ray& ray, double limit_m, Optics optics) {
  constexpr int kSteps = 200000;
  const RayInterval interval = Clip(medium, ray, limit_m);
  const double step_m = std::max(interval.end_m - interval.begin_m, 0.0) / kSteps;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    sum += medium.Extinction_per_m(ray.At(interval.begin_m + (i + 0.5) * step_m), optics);
  }
  return sum * step_m;
}

// Compares transmittances, and the share of flights without collision, with a quadrature along 6
// rays through each of 6 media. Estimates of transmittances up to an optical depth of 0.9 have no
// noise. At the walls of constant cells, the quadrature's midpoints may be wrong by up to 4 of
// 200000 steps.
TEST_P(MediumWith, TransmittanceIsThatOfQuadrature) {
  constexpr double kLimit_m = 1500.0;
  for (const Case& test : Cases()) {
    SCOPED_TRACE(test.name);
    const auto medium = Made(test.description);
    RandomStream rays(11, 0, 0);
    for (int r = 0; r < 6; ++r) {
      Ray ray = RandomRay(*medium, &rays);
      double depth = DepthWithin(*medium, ray, kLimit_m, GetParam());
      for (int i = 0; i < 200 && depth < 0.1; ++i) {
        ray = RandomRay(*medium, &rays);
        depth = DepthWithin(*medium, ray, kLimit_m, GetParam());
      }
      ASSERT_GE(depth, 0.1);
      SampleMean passed;
      SampleMean flights;
      for (std::uint32_t i = 0; i < 20000; ++i) {
        RandomStream random(23, static_cast<std::uint64_t>(r), i);
        const double transmittance =
            EstimateTransmittance(*medium, ray, kLimit_m, &random, GetParam());
        passed.Add(transmittance);
        if (depth < 0.9) {
          ASSERT_NEAR(transmittance, std::exp(-depth), 1e-4);
        }
        const auto met = SampleCollision(*medium, ray, kLimit_m, &random, GetParam());
        flights.Add(met.has_value() ? 0.0 : 1.0);
      }
      ExpectAgrees(passed.Share(), std::exp(-depth), 1e-4, 4e-3);
      ExpectAgrees(flights.Share(), std::exp(-depth), 1e-4, 4e-3);
    }
  }
}

// With Russian roulette the mean is correct in thick media too.
TEST(Tracking, SmallTransmittance) {
  const auto slab = Slab(6.0, 0.0, 1.0);
  const Ray down{{0.0, 0.0, slab->High_m().z}, {0.0, 0.0, -1.0}};
  SampleMean mean;
  for (std::uint32_t i = 0; i < 400000; ++i) {
    RandomStream random(29, 0, i);
    mean.Add(EstimateTransmittance(*slab, down, kNoLimit_m, &random));
  }
  ExpectAgrees(mean.Share(), std::exp(-6.0), 0.0, 1e-4);
}

TEST(Tracking, LevelRaysEnd) {
  MediumDescription lines = Chessboard(0.0, 0.0, 1.0, 0.0);
  lines.groups[0].extinction_per_m[0] = 1.0F;
  const auto medium = Made(lines);
  const glm::dvec3 clear = medium->Low_m() + glm::dvec3(100.0, 1900.0, 100.0);
  RandomStream random(1, 0, 0);
  EXPECT_FALSE(SampleCollision(*medium, {clear, {1.0, 0.0, 0.0}}, kNoLimit_m, &random).has_value());
  const auto nothing = Made(Chessboard(0.0, 0.0, 1.0, 0.0));
  EXPECT_EQ(EstimateTransmittance(*nothing, {clear, {0.0, 1.0, 0.0}}, kNoLimit_m, &random), 1.0);
}

TEST(Deflect, TurnsByTheAngleAsked) {
  RandomStream random(2, 0, 0);
  for (int i = 0; i < 1000; ++i) {
    const glm::dvec3 direction = Deflect({0.0, 0.0, i % 2 == 0 ? 1.0 : -1.0},
                                         2.0 * random.Uniform() - 1.0, 6.3 * random.Uniform());
    const double mu = 2.0 * random.Uniform() - 1.0;
    const glm::dvec3 turned = Deflect(direction, mu, 6.3 * random.Uniform());
    EXPECT_NEAR(glm::dot(direction, turned), mu, 1e-12);
    EXPECT_NEAR(glm::length(turned), 1.0, 1e-12);
  }
}

}  // namespace
}  // namespace thunderhead::reference
