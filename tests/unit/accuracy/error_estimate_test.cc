#include "accuracy/error_estimate.h"

#include <cmath>

#include "gtest/gtest.h"
#include "reference/philox.h"

namespace thunderhead::accuracy {
namespace {

// A simulated picture with a mean radiance of about 1, whose error varies from pixel to pixel. The
// estimates of its traced paths are mostly too small and sometimes far too large.
struct Picture {
  double bias = 0.1;    // mean of (drawn - reference) / reference over the pixels
  double spread = 0.2;  // standard deviation of the pixels' relative errors about the bias
  double noise = 1.5;   // standard deviation of a path's estimate, divided by the reference
  double reference = 1.0;
  double spikes = 0.0;   // fraction of the light that comes from rare, far brighter paths
  double spike = 100.0;  // brightness of these paths relative to the others

  double Error() const { return std::sqrt(bias * bias + spread * spread); }

  ErrorEstimate Traced(int pixels, int paths, std::uint64_t seed) const {
    // The drawn picture's mean is known. Half of the pixels' errors lie above its bias, and half
    // below.
    ErrorEstimate estimate(reference * (1.0 + bias));
    for (int i = 0; i < pixels; ++i) {
      reference::RandomStream random(seed, static_cast<std::uint64_t>(i), 0);
      const double error = bias + (random.Uniform() < 0.5 ? -spread : spread);
      PixelReference pixel(reference);
      for (int path = 0; path < paths; ++path) {
        // The noise has the high value with probability p; its mean is 0 and its standard deviation
        // 1.
        constexpr double kShare = 0.1;
        const double luck = random.Uniform() < kShare ? std::sqrt((1.0 - kShare) / kShare)
                                                      : -std::sqrt(kShare / (1.0 - kShare));
        const bool is_spike = spikes > 0.0 && random.Uniform() < spikes / spike;
        pixel.Add(glm::dvec3(reference *
                             ((1.0 - spikes) * (1.0 + noise * luck) + (is_spike ? spike : 0.0))));
      }
      estimate.Add(glm::dvec3(reference + error * reference), pixel);
    }
    return estimate;
  }
};

TEST(ErrorEstimate, TheReferencesNoiseIsNoError) {
  const Picture right{.bias = 0.0, .spread = 0.0};
  double mean = 0.0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const auto error = right.Traced(2000, 16, seed).Result();
    ASSERT_TRUE(error.has_value());
    EXPECT_LT(error->relative_rmse.low, 0.05);
    // If the noise of the path estimates were counted as the picture's error, the result would be
    // 1.5 / sqrt(16) = 0.375.
    EXPECT_LT(error->relative_rmse.high, 0.15);
    mean += error->relative_bias.value / 20.0;
  }
  EXPECT_NEAR(mean, 0.0, 0.006);
}

TEST(ErrorEstimate, IntervalsHoldTheErrorAsOftenAsTheySay) {
  for (const Picture& picture : {Picture{}, Picture{.bias = -0.3, .spread = 0.4},
                                 Picture{.bias = 0.02, .spread = 0.1, .reference = 40.0},
                                 Picture{.bias = 0.05, .spread = 0.2, .spikes = 0.01}}) {
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
    // 95 % of the 200 intervals should contain the error: 190 +- 3. The intervals are wider than
    // the noise requires, because they include the possible bias of clamping and the reference's
    // own uncertainty. Other tests check their width.
    EXPECT_GE(held, 180);
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

TEST(ErrorEstimate, RarePathsOfGreatBrightnessWidenNothing) {
  // The variance of these paths, 0.003 * 1000, is twelve times that of all others.
  const auto width = [](const Picture& picture) {
    double sum = 0.0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      const auto error = picture.Traced(2000, 16, seed).Result();
      sum += error->relative_rmse.high - error->relative_rmse.low;
    }
    return sum;
  };
  EXPECT_LT(width({.noise = 0.5, .spikes = 0.003, .spike = 1000.0}), 1.4 * width({.noise = 0.5}));
}

TEST(ErrorEstimate, ClampedLightIsGivenBack) {
  PixelReference pixel(2.0);
  pixel.Add(glm::dvec3(1.0, 2.0, 3.0));
  pixel.Add(glm::dvec3(10.0, 20.0, 30.0));
  EXPECT_EQ(pixel.Clamped(kClamps.size() - 1).first, glm::dvec3(11.0, 22.0, 33.0));
  // The estimate is limited to 4 times the drawn value, and keeps its hue.
  EXPECT_NEAR(pixel.Clamped(0).first.x, 1.0 + 4.0, 1e-12);
  EXPECT_NEAR(pixel.Clamped(0).first.z, 3.0 + 12.0, 1e-12);
  double mean = 0.0;
  const Picture right{.bias = 0.0, .spread = 0.0, .noise = 0.3, .spikes = 0.009};
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    mean += right.Traced(4000, 16, seed).Result()->relative_bias.value / 40.0;
  }
  EXPECT_NEAR(mean, 0.0, 0.003) << "0.009 if it were lost";
}

TEST(ErrorEstimate, PixelsCountByTheirWeight) {
  // Twice as many pixels are traced in the left half as in the right half, whose error is three
  // times as large.
  ErrorEstimate estimate(1.0);
  for (int i = 0; i < 30000; ++i) {
    reference::RandomStream random(3, static_cast<std::uint64_t>(i), 0);
    const bool left = random.Uniform() < 2.0 / 3.0;
    PixelReference pixel(1.0, left ? 0.75 : 1.5);
    const double reference = 1.0 + (left ? 0.1 : 0.3) * (random.Uniform() < 0.5 ? -1.0 : 1.0);
    for (int path = 0; path < 4; ++path) {
      pixel.Add(glm::dvec3(reference * 2.0 * random.Uniform()));
    }
    estimate.Add(glm::dvec3(1.0), pixel);
  }
  EXPECT_NEAR(estimate.Result()->relative_rmse.value, std::sqrt(0.5 * (0.01 + 0.09)), 0.01);
}

TEST(ErrorEstimate, FewPixelsAndBlackPicturesSayNothing) {
  EXPECT_FALSE(Picture{}.Traced(100, 16, 1).Result().has_value());
  ErrorEstimate black(0.0);
  PixelReference none(1.0);
  for (int i = 0; i < 4; ++i) none.Add(glm::dvec3(0.0));
  for (int i = 0; i < 1000; ++i) black.Add(glm::dvec3(0.0), none);
  EXPECT_FALSE(black.Result().has_value());
}

}  // namespace
}  // namespace thunderhead::accuracy
