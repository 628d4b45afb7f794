// Comparisons of Monte Carlo estimates with known answers, and media to compare on. Seeds are
// fixed, so a test's outcome is too. The limit is chosen so that a correct program with fresh seeds
// would fail one or more of the folder's comparisons once in 100 runs.
#pragma once

#include <cmath>
#include <memory>
#include <numbers>

#include "gtest/gtest.h"
#include "reference/flux.h"
#include "reference/medium.h"

namespace thunderhead::reference {

// An upper bound on the number of comparisons in this folder. Bonferroni's correction divides by
// it.
inline constexpr int kComparisons = 200;
inline constexpr double kFamilyErrorRate = 0.01;

// Returns the number of standard errors that a correct estimate exceeds with kFamilyErrorRate in
// all: 4.06.
inline double LargestZ() {
  const double tail = kFamilyErrorRate / kComparisons;
  double low = 0.0;
  double high = 10.0;
  for (int i = 0; i < 60; ++i) {
    const double z = 0.5 * (low + high);
    (std::erfc(z / std::numbers::sqrt2) > tail ? low : high) = z;
  }
  return low;
}

// Expects that the estimate agrees with `expected`. `slack` is the possible error of `expected`
// itself, such as the rounding of a printed figure. An estimate less precise than `largest_error`
// proves nothing and fails.
inline void ExpectAgrees(const FluxShare& estimate, double expected, double slack,
                         double largest_error) {
  EXPECT_LE(estimate.standard_error, largest_error) << "too noisy to compare";
  EXPECT_LE(std::abs(estimate.value - expected), LargestZ() * estimate.standard_error + slack)
      << "estimate " << estimate.value << " +- " << estimate.standard_error << ", expected "
      << expected << ": z = " << (estimate.value - expected) / estimate.standard_error;
}

inline void ExpectAgree(const FluxShare& a, const FluxShare& b, double largest_error) {
  const FluxShare difference{a.value - b.value, std::hypot(a.standard_error, b.standard_error)};
  ExpectAgrees(difference, 0.0, 0.0, largest_error);
}

// The mean and standard error of repeated draws.
class SampleMean {
 public:
  void Add(double value) {
    ++count_;
    const double before = value - mean_;
    mean_ += before / count_;
    squares_ += before * (value - mean_);
  }
  FluxShare Share() const { return {mean_, std::sqrt(squares_ / count_ / (count_ - 1.0))}; }

 private:
  double count_ = 0.0;
  double mean_ = 0.0;
  double squares_ = 0.0;
};

// Returns the direction towards a sun in the east at an angle from the zenith.
inline glm::dvec3 SunAt(double zenith_deg) {
  const double zenith = zenith_deg * std::numbers::pi / 180.0;
  return {std::sin(zenith), 0.0, std::cos(zenith)};
}

inline std::shared_ptr<const SampledPhase> HenyeyGreensteinPhase(double g) {
  return std::make_shared<const SampledPhase>(SampledPhase::HenyeyGreenstein(g));
}

inline std::shared_ptr<const Medium> Slab(double optical_depth, double g, double albedo) {
  return *SlabMedium(optical_depth, SampledPhase::HenyeyGreenstein(g), albedo);
}

// Returns a medium whose box is a grid with cells of the given size and an arbitrary lower corner.
inline MediumDescription EmptyDescription(const glm::ivec3& cells, const glm::dvec3& spacing_m) {
  MediumDescription description;
  description.grid = {cells, spacing_m, {-300.0, 120.0, 40.0}};
  description.low_m = description.grid.low_corner_m;
  description.high_m = description.grid.HighCorner_m();
  return description;
}

// Returns a lumpy cloud of 9 x 7 x 6 cells with gaps, with extinction up to `densest_per_m`.
inline MediumDescription LumpyCloud(double densest_per_m, double albedo, double g) {
  MediumDescription cloud = EmptyDescription({9, 7, 6}, {100.0, 130.0, 70.0});
  ScatteringGroup group{{}, glm::dvec3(albedo), HenyeyGreensteinPhase(g)};
  RandomStream random(17, 0, 0);
  for (std::size_t i = 0; i < cloud.grid.CellCount(); ++i) {
    const double lump = random.Uniform();
    group.extinction_per_m.push_back(
        static_cast<float>(lump < 0.4 ? 0.0 : densest_per_m * lump * lump));
  }
  cloud.groups.push_back(std::move(group));
  return cloud;
}

// Returns columns with vertical walls that alternate between the extinctions `low_per_m` and
// `high_per_m` like a chessboard. There are 8 x 8 columns of 500 m, 250 m tall.
inline MediumDescription Chessboard(double low_per_m, double high_per_m, double albedo, double g) {
  MediumDescription board = EmptyDescription({8, 8, 1}, {500.0, 500.0, 250.0});
  board.interpolation = Interpolation::kConstant;
  board.sides = Sides::kPeriodic;
  ScatteringGroup group{{}, glm::dvec3(albedo), HenyeyGreensteinPhase(g)};
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) {
      group.extinction_per_m.push_back(
          static_cast<float>((x + y) % 2 == 0 ? low_per_m : high_per_m));
    }
  }
  board.groups.push_back(std::move(group));
  return board;
}

inline std::shared_ptr<const Medium> Made(MediumDescription description) {
  auto medium = Medium::Create(std::move(description));
  EXPECT_TRUE(medium.ok()) << medium.status();
  return *std::move(medium);
}

}  // namespace thunderhead::reference
