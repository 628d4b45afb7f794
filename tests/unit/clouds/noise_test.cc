#include "clouds/noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "clouds/repeatable_math.h"

namespace thunderhead::clouds {
namespace {

// Evaluates the same formula in 64-bit integers without overflow, taken modulo 2^31 at the end.
double InWideIntegers(std::int64_t x, std::int64_t y, std::int64_t z) {
  const std::uint64_t m = static_cast<std::uint64_t>(x + 57 * y + 57 * 57 * z) & 0xffffffffU;
  const std::uint64_t n = ((m << 13U) ^ m) & 0xffffffffU;
  const std::uint64_t square = (n * n) & 0xffffffffU;
  const std::uint64_t inner = (square * 15731U + 789221U) & 0xffffffffU;
  const std::uint64_t mixed = (n * inner + 1376312589U) & 0x7fffffffU;
  return 1.0 - static_cast<double>(mixed) / 1073741824.0;
}

TEST(LatticeNoise, IsThePrintedFormulaInUnsignedArithmetic) {
  for (std::int32_t z = -9; z < 9; z += 3) {
    for (std::int32_t y = -200; y < 200; y += 37) {
      for (std::int32_t x = -100000; x < 100000; x += 9973) {
        EXPECT_EQ(LatticeNoise(x, y, z), InWideIntegers(x, y, z));
      }
    }
  }
  // Computed by hand: m = 0 gives n = 0 and 1376312589.
  EXPECT_EQ(LatticeNoise(0, 0, 0), 1.0 - 1376312589.0 / 1073741824.0);
}

TEST(LatticeNoise, IsUniformFromMinusOneToOne) {
  double sum = 0.0;
  double squares = 0.0;
  int count = 0;
  for (std::int32_t i = 0; i < 40000; ++i) {
    const double value = LatticeNoise(i % 50, i / 50 % 40, i / 2000);
    EXPECT_GT(value, -1.0);
    EXPECT_LE(value, 1.0);
    sum += value;
    squares += value * value;
    ++count;
  }
  // The standard errors are 0.0029 and 0.0015. The tolerances are 5 standard errors.
  EXPECT_NEAR(sum / count, 0.0, 0.015);
  EXPECT_NEAR(squares / count, 1.0 / 3.0, 0.008);
}

TEST(SmoothNoise, WeightsAddUpToOneByRing) {
  // The expected value sums each ring by hand at one place.
  double expected = 9.0 / 18.0 * LatticeNoise(3, -4, 5);
  for (int i = 0; i < 27; ++i) {
    const int dx = i % 3 - 1;
    const int dy = i / 3 % 3 - 1;
    const int dz = i / 9 - 1;
    const double value = LatticeNoise(3 + dx, -4 + dy, 5 + dz);
    const int ring = std::abs(dx) + std::abs(dy) + std::abs(dz);
    if (ring == 1) expected += 4.0 / 108.0 * value;
    if (ring == 2) expected += 3.0 / 216.0 * value;
    if (ring == 3) expected += 2.0 / 144.0 * value;
  }
  EXPECT_NEAR(SmoothNoise(3, -4, 5), expected, 1e-15);
}

TEST(InterpolationWeights, AreThePrintedInterpolations) {
  const double v[4] = {0.3, -0.7, 0.9, 0.2};
  for (const double x : {0.0, 0.25, 0.6, 1.0}) {
    const auto apply = [&](NoiseInterpolation kind) {
      const auto w = InterpolationWeights(kind, x);
      return w[0] * v[0] + w[1] * v[1] + w[2] * v[2] + w[3] * v[3];
    };
    EXPECT_NEAR(apply(NoiseInterpolation::kLinear), v[1] * (1 - x) + v[2] * x, 1e-15);
    const double f = 1.0 - std::cos(std::numbers::pi * x);
    EXPECT_NEAR(apply(NoiseInterpolation::kCosine), v[1] * (1 - 0.5 * f) + 0.5 * v[2] * f, 1e-14);
    const double p = (v[3] - v[2]) - (v[0] - v[1]);
    const double q = v[0] - v[1] - p;
    const double r = v[2] - v[0];
    EXPECT_NEAR(apply(NoiseInterpolation::kCubic), ((p * x + q) * x + r) * x + v[1], 1e-14);
  }
}

TEST(RepeatableMath, IsSineAndCosine) {
  for (double degrees = -1000.0; degrees < 1000.0; degrees += 7.3) {
    const double radians = degrees * std::numbers::pi / 180.0;
    EXPECT_NEAR(SineOfDegrees(degrees), std::sin(radians), 5e-15) << degrees;
    EXPECT_NEAR(CosineOfDegrees(degrees), std::cos(radians), 5e-15) << degrees;
  }
}

// Slices and the plain sum must give the same function.
TEST(NoiseSlices, AgreeWithTheFunctionAtEveryCell) {
  for (const auto interpolation :
       {NoiseInterpolation::kLinear, NoiseInterpolation::kCosine, NoiseInterpolation::kCubic}) {
    for (const std::uint64_t seed : {0U, 7U}) {
      const NoiseParameters parameters{4, 0.6, interpolation, seed};
      const NoiseAxis x{-2.3, 0.17, 12};
      const NoiseAxis y{-0.9, 0.21, 9};
      NoiseSlices slices(parameters, x, y);
      for (const double z : {-1.7, -1.65, 0.0, 0.4, 3.1}) {
        const std::vector<double>& slice = slices.At(z);
        for (int j = 0; j < y.count; ++j) {
          for (int i = 0; i < x.count; ++i) {
            const double expected =
                Noise(parameters, x.first + x.step * i, y.first + y.step * j, z);
            EXPECT_NEAR(slice[static_cast<std::size_t>(j * x.count + i)], expected, 1e-13);
          }
        }
      }
    }
  }
}

TEST(Noise, IsContinuousAcrossLatticeCells) {
  const NoiseParameters parameters;
  for (int i = -5; i < 5; ++i) {
    const double below = Noise(parameters, i - 1e-9, 0.3, 0.7);
    EXPECT_NEAR(Noise(parameters, i + 1e-9, 0.3, 0.7), below, 1e-7);
  }
}

}  // namespace
}  // namespace thunderhead::clouds
