#include "accuracy/correction_fit.h"

#include <cmath>
#include <functional>

#include "glm/geometric.hpp"
#include "gtest/gtest.h"
#include "reference/philox.h"

namespace thunderhead::accuracy {
namespace {

using Law = std::function<glm::dvec3(const glm::dvec3& place, const glm::dvec3& direction)>;

class CorrectionFitTest : public testing::Test {
 protected:
  // Adds rays through random places of the box from `low` to `high`, in random directions. Each ray
  // has a drawn brightness from 0.2 to 1. Its path-traced estimate is the drawn brightness, times
  // the factor `law`, times noise with mean 1.
  void AddRays(int count, const Law& law, double noise, const glm::dvec3& low = glm::dvec3(0.0),
               const glm::dvec3& high = glm::dvec3(1.0)) {
    for (int i = 0; i < count; ++i) {
      reference::RandomStream random(3, static_cast<std::uint64_t>(next_++), 0);
      const auto uniform = [&] { return random.Uniform(); };
      CorrectedRay ray;
      ray.place = low + (high - low) * glm::dvec3(uniform(), uniform(), uniform());
      ray.direction = glm::normalize(glm::dvec3(uniform(), uniform(), uniform()) - glm::dvec3(0.5));
      ray.drawn = glm::dvec3(0.2 + 0.8 * uniform());
      // The noise is distributed like path estimates: mostly too small, sometimes far too large.
      const double luck = uniform() < 0.2 ? 1.0 + 4.0 * noise : 1.0 - noise;
      ray.estimate = luck * law(ray.place, ray.direction) * ray.drawn;
      fit_.Add(ray);
    }
  }

  // Returns the factor of a texel along `direction`.
  glm::dvec3 FactorAt(const glm::ivec3& texel, const glm::dvec3& direction) const {
    const Factors factors =
        fit_.Solve()[static_cast<std::size_t>((texel.z * 16 + texel.y) * 16 + texel.x)];
    const glm::vec4 by(1.0F, glm::vec3(direction));
    return {glm::dot(factors[0], by), glm::dot(factors[1], by), glm::dot(factors[2], by)};
  }

  static constexpr glm::dvec3 kUp{0.0, 0.0, 1.0};

  CorrectionFit fit_{{16, 16, 4}};
  std::int64_t next_ = 0;
};

TEST_F(CorrectionFitTest, WithoutRaysNothingIsCorrected) {
  for (const Factors& factors : fit_.Solve()) {
    for (const glm::vec4& color : factors) EXPECT_EQ(color, glm::vec4(1.0F, 0.0F, 0.0F, 0.0F));
  }
}

TEST_F(CorrectionFitTest, ExactRaysGiveTheirFactorBack) {
  AddRays(
      200'000, [](const auto&, const auto&) { return glm::dvec3(0.5, 1.0, 1.5); }, 0.0);
  const glm::dvec3 factor = FactorAt({7, 3, 2}, kUp);
  EXPECT_NEAR(factor.x, 0.5, 0.02);
  EXPECT_NEAR(factor.y, 1.0, 0.02);
  EXPECT_NEAR(factor.z, 1.5, 0.02);
}

TEST_F(CorrectionFitTest, FactorsFollowPlaceAndDirection) {
  const Law law = [](const glm::dvec3& place, const glm::dvec3& direction) {
    return glm::dvec3(0.5 + place.x + 0.3 * direction.z);
  };
  AddRays(400'000, law, 0.0);
  for (const int x : {3, 8, 12}) {
    for (const double z : {-1.0, 0.0, 1.0}) {
      const glm::dvec3 direction(std::sqrt(1.0 - z * z), 0.0, z);
      EXPECT_NEAR(FactorAt({x, 8, 2}, direction).x, law(glm::dvec3((x + 0.5) / 16.0), direction).x,
                  0.03)
          << x << " " << z;
    }
  }
}

TEST_F(CorrectionFitTest, NoiseIsAveragedOverMoreThanATexel) {
  // There are 50 rays per texel, and a ray's noise has a standard deviation of twice its value. A
  // factor fitted to one texel alone would have a relative error of 0.28.
  AddRays(
      50 * 1024, [](const auto&, const auto&) { return glm::dvec3(1.4); }, 1.0);
  double squares = 0.0;
  for (int x = 0; x < 16; ++x) squares += std::pow(FactorAt({x, 9, 1}, kUp).x - 1.4, 2);
  EXPECT_LT(std::sqrt(squares / 16.0), 0.1);
}

TEST_F(CorrectionFitTest, ManyNoisyRaysSettleATexelByItself) {
  const Law law = [](const glm::dvec3& place, const auto&) {
    return glm::dvec3(place.y < 0.5 ? 0.7 : 1.3);
  };
  AddRays(2'000'000, law, 1.0);
  EXPECT_NEAR(FactorAt({5, 5, 1}, kUp).x, 0.7, 0.1);
  EXPECT_NEAR(FactorAt({5, 10, 1}, kUp).x, 1.3, 0.1);
}

// In both cases the noise is the same and there are few rays. Factors that differ much between
// texels must not be pulled to their mean, and similar factors must not follow the noise. The fit
// determines from the rays how much the factors differ.
TEST_F(CorrectionFitTest, FactorsThatDifferMuchAreFollowedSooner) {
  for (const double half : {0.0, 0.6}) {
    fit_ = CorrectionFit({16, 16, 4});
    const Law law = [&](const glm::dvec3& place, const auto&) {
      return glm::dvec3(std::fmod(4.0 * place.y, 2.0) < 1.0 ? 1.0 - half : 1.0 + half);
    };
    AddRays(4 * 1024, law, 0.2);
    double squares = 0.0;
    for (int x = 0; x < 16; ++x) {
      squares += std::pow(FactorAt({x, 9, 1}, kUp).x - (1.0 - half), 2);
      squares += std::pow(FactorAt({x, 6, 1}, kUp).x - (1.0 + half), 2);
    }
    // With fixed smoothing (0.1 between places and 0.05 between directions) instead of smoothing
    // that follows from the rays, the errors would be 0.06 and 0.25.
    EXPECT_LT(std::sqrt(squares / 32.0), half > 0.0 ? 0.2 : 0.04) << half;
  }
}

// A factor fitted to rays of one direction must not be used for rays of another.
TEST_F(CorrectionFitTest, AFactorOfOneDirectionSaysLittleOfTheOpposite) {
  const Law law = [](const auto&, const glm::dvec3& direction) {
    return glm::dvec3(direction.z > 0.0 ? 1.3 : 1.0);
  };
  const auto add_from = [&](int count, double side) {
    for (int i = 0; i < count; ++i) {
      reference::RandomStream random(5, static_cast<std::uint64_t>(next_++), 0);
      const auto uniform = [&] { return random.Uniform(); };
      const glm::dvec3 place(uniform(), uniform(), uniform());
      const glm::dvec3 direction =
          glm::normalize(glm::dvec3(0.3 * uniform(), 0.3 * uniform(), side));
      const double luck = uniform() < 0.2 ? 3.0 : 0.5;
      fit_.Add({place, direction, glm::dvec3(1.0), luck * law(place, direction)});
    }
  };
  add_from(20'000, 1.0);
  add_from(500, -1.0);
  EXPECT_NEAR(FactorAt({8, 8, 2}, kUp).x, 1.3, 0.06);
  EXPECT_NEAR(FactorAt({8, 8, 2}, -kUp).x, 1.0, 0.12);
}

TEST_F(CorrectionFitTest, BrightRaysCountForMore) {
  // A texel's factor conserves its total light, so the factor 3 of the dim rays hardly counts.
  AddRays(
      20'000, [](const auto&, const auto&) { return glm::dvec3(1.0); }, 0.0);
  for (int i = 0; i < 640; ++i) {
    fit_.Add({glm::dvec3((i % 64 + 0.5) / 64.0), kUp, glm::dvec3(1e-3), glm::dvec3(3e-3)});
  }
  EXPECT_NEAR(FactorAt({8, 8, 2}, kUp).x, 1.0, 0.05);
}

TEST_F(CorrectionFitTest, BlackRaysSayNothing) {
  fit_.Add({glm::dvec3(0.5), kUp, glm::dvec3(0.0), glm::dvec3(1.0)});
  fit_.Add({glm::dvec3(0.5), kUp, glm::dvec3(std::nan("")), glm::dvec3(1.0)});
  EXPECT_EQ(fit_.Rays(), 0);
  EXPECT_EQ(FactorAt({8, 8, 2}, kUp), glm::dvec3(1.0));
}

TEST_F(CorrectionFitTest, WhatIsFarFromAnyRayTakesTheMeanOfAll) {
  AddRays(
      100'000, [](const auto&, const auto&) { return glm::dvec3(0.8); }, 0.0, glm::dvec3(0.0),
      glm::dvec3(0.2, 1.0, 1.0));
  EXPECT_NEAR(FactorAt({15, 8, 2}, kUp).x, 0.8, 0.05);
}

}  // namespace
}  // namespace thunderhead::accuracy
