#include "accuracy/error_estimate.h"

#include <cmath>
#include <vector>

#include "gtest/gtest.h"
#include "reference/philox.h"

namespace thunderhead::accuracy {
namespace {

// A picture of mean radiance about 1 whose error varies from pixel to pixel, and paths whose
// estimates are mostly too small and sometimes far too large.
struct Picture {
  double bias = 0.1;    // (drawn - truth) / truth, of every pixel
  double spread = 0.2;  // of the pixels' errors besides
  double noise = 1.5;   // standard deviation of a path over the truth
  double truth = 1.0;

  double Error() const { return std::sqrt(bias * bias + spread * spread); }

  ErrorEstimate Traced(int pixels, int paths, std::uint64_t seed) const {
    ErrorEstimate estimate;
    std::vector<glm::dvec3> estimates(static_cast<std::size_t>(paths));
    for (int i = 0; i < pixels; ++i) {
      reference::RandomStream random(seed, static_cast<std::uint64_t>(i), 0);
      const double error = bias + (random.Uniform() < 0.5 ? -spread : spread);
      for (glm::dvec3& one : estimates) {
        // With share p at the high value, mean 0 and standard deviation 1.
        constexpr double kShare = 0.1;
        const double luck = random.Uniform() < kShare ? std::sqrt((1.0 - kShare) / kShare)
                                                      : -std::sqrt(kShare / (1.0 - kShare));
        one = glm::dvec3(truth * (1.0 + noise * luck));
      }
      estimate.Add(glm::dvec3(truth + error * truth), estimates);
    }
    return estimate;
  }
};

TEST(ErrorEstimate, TheTruthsNoiseIsNoError) {
  const Picture right{.bias = 0.0, .spread = 0.0};
  double mean = 0.0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const auto error = right.Traced(2000, 16, seed).Result();
    ASSERT_TRUE(error.has_value());
    EXPECT_LT(error->relative_rmse.low, 0.05);
    // Paths alone, taken for the truth, would say 1.5 / sqrt(16) = 0.375.
    EXPECT_LT(error->relative_rmse.high, 0.15);
    mean += error->relative_bias.value / 20.0;
  }
  EXPECT_NEAR(mean, 0.0, 0.006);
}

TEST(ErrorEstimate, IntervalsHoldTheErrorAsOftenAsTheySay) {
  for (const Picture& picture : {Picture{}, Picture{.bias = -0.3, .spread = 0.4},
                                 Picture{.bias = 0.02, .spread = 0.1, .truth = 40.0}}) {
    int held = 0;
    int held_bias = 0;
    constexpr int kTrials = 200;
    for (int trial = 0; trial < kTrials; ++trial) {
      const auto error = picture.Traced(1200, 16, static_cast<std::uint64_t>(trial)).Result();
      ASSERT_TRUE(error.has_value());
      const Estimated& rmse = error->relative_rmse;
      held += rmse.low <= picture.Error() && picture.Error() <= rmse.high ? 1 : 0;
      const Estimated& bias = error->relative_bias;
      held_bias += bias.low <= picture.bias && picture.bias <= bias.high ? 1 : 0;
    }
    // 95 % of 200 is 190 +- 3.
    EXPECT_GE(held, 180);
    EXPECT_LE(held, 199);
    EXPECT_GE(held_bias, 180);
    EXPECT_LE(held_bias, 199);
  }
}

TEST(ErrorEstimate, MorePixelsNarrowTheInterval) {
  const Picture picture;
  const auto width = [&](int pixels) {
    const auto error = picture.Traced(pixels, 16, 1).Result();
    return error->relative_rmse.high - error->relative_rmse.low;
  };
  EXPECT_NEAR(width(16000) / width(1000), 0.25, 0.1);
}

TEST(ErrorEstimate, TheBestNumberOfPathsGivesTheNarrowestInterval) {
  constexpr int kPaths = 200'000;
  for (const Picture& picture :
       {Picture{.bias = 0.1, .spread = 0.02}, Picture{.bias = 0.4, .spread = 0.6}}) {
    const int best = picture.Traced(4000, 16, 7).BestPathsPerPixel(256);
    const auto width = [&](int paths) {
      double sum = 0.0;
      for (std::uint64_t seed = 0; seed < 8; ++seed) {
        const auto error = picture.Traced(kPaths / paths, paths, seed).Result();
        sum += error->relative_rmse.high - error->relative_rmse.low;
      }
      return sum;
    };
    EXPECT_LT(width(best), 1.1 * width(best * 4)) << best;
    EXPECT_LT(width(best), 1.1 * width(std::max(best / 4, 2))) << best;
  }
}

TEST(ErrorEstimate, FewPixelsAndBlackPicturesSayNothing) {
  EXPECT_FALSE(Picture{}.Traced(100, 16, 1).Result().has_value());
  ErrorEstimate black;
  const std::vector<glm::dvec3> none(4, glm::dvec3(0.0));
  for (int i = 0; i < 1000; ++i) black.Add(glm::dvec3(0.0), none);
  EXPECT_FALSE(black.Result().has_value());
}

}  // namespace
}  // namespace thunderhead::accuracy
