#include "physics/detail_tile.h"

#include <array>
#include <cmath>
#include <cstdint>

#include "gtest/gtest.h"

namespace thunderhead::physics {
namespace {

double DetailMean(const DetailTile& tile, std::size_t channel) {
  double sum = 0.0;
  for (std::size_t i = channel; i < tile.texels.size(); i += 4) sum += tile.texels[i];
  return 4.0 * sum / static_cast<double>(tile.texels.size());
}

std::uint64_t DetailHash(const DetailTile& tile) {
  std::uint64_t hash = 14695981039346656037U;  // FNV-1a
  for (const std::uint8_t texel : tile.texels) hash = (hash ^ texel) * 1099511628211U;
  return hash;
}

TEST(DetailTile, AllBillowsAreEquallyFrequent) {
  const DetailTile tile = MakeDetailTile(4, 1);
  std::array<std::size_t, 256> counts{};
  for (std::size_t i = 0; i < tile.texels.size(); i += 4) ++counts[tile.texels[i]];
  const double even = static_cast<double>(tile.texels.size()) / 4.0 / 256.0;
  // The tile's noise is made uniform by ranks, which are computed in 65536 bins, so the counts are
  // not exactly even.
  for (const std::size_t count : counts) {
    EXPECT_NEAR(static_cast<double>(count) / even, 1.0, 0.1);
  }
  EXPECT_NEAR(DetailMean(tile, 0), 127.5, 0.2);
}

TEST(DetailTile, DisplacesNothingOnAverage) {
  const DetailTile tile = MakeDetailTile(4, 1);
  for (const std::size_t axis : {1U, 2U, 3U}) EXPECT_NEAR(DetailMean(tile, axis), 127.5, 0.6);
}

TEST(DetailTile, HasNoSeam) {
  const DetailTile tile = MakeDetailTile(2, 3);
  double across_seam = 0.0;
  double inside = 0.0;
  constexpr double kTexel = 1.0 / DetailTile::kSide;
  for (int i = 0; i < 4000; ++i) {
    const glm::dvec3 place(0.5, 0.37 * i, 0.11 * i);
    const auto step = [&](double x) {
      const glm::dvec4 rise = DetailNoiseAt(tile, {x + 0.5 * kTexel, place.y, place.z}) -
                              DetailNoiseAt(tile, {x - 0.5 * kTexel, place.y, place.z});
      return std::abs(rise.x) + std::abs(rise.y) + std::abs(rise.z) + std::abs(rise.w);
    };
    across_seam += step(1.0);
    inside += step(0.5);
  }
  EXPECT_NEAR(across_seam / inside, 1.0, 0.1);
}

TEST(DetailTile, RepeatsAndDependsOnTheSeed) {
  const DetailTile tile = MakeDetailTile(1, 3);
  const glm::dvec3 place(0.31, 0.77, 0.05);
  const glm::dvec4 here = DetailNoiseAt(tile, place);
  const glm::dvec4 there = DetailNoiseAt(tile, place + glm::dvec3(-2.0, 1.0, 7.0));
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(here[i], there[i], 1e-9);
  EXPECT_NE(tile.texels, MakeDetailTile(1, 4).texels);
}

TEST(DetailTile, HasTheSameBitsEverywhere) {
  EXPECT_EQ(DetailHash(MakeDetailTile(4, 1)), 9905576374110571487U);
}

TEST(DetailTile, CoarserLevelsKeepTheMean) {
  DetailTile tile = MakeDetailTile(4, 1);
  const double mean = DetailMean(tile, 0);
  for (int side = DetailTile::kSide; side > 1; side /= 2) {
    tile.texels = CoarserLevel(tile.texels, side);
    EXPECT_NEAR(DetailMean(tile, 0), mean, 0.6)
        << side;  // rounding at each mip level shifts the mean
  }
  EXPECT_EQ(tile.texels.size(), 4U);
}

TEST(DetailFactor, KeepsAMediumWithoutTurbulence) {
  for (const float noise : {0.0F, 0.3F, 1.0F}) {
    EXPECT_EQ(glsl::detail_factor({0.3F, 0.0F}, noise, 0.0F), 1.0F);
  }
}

TEST(DetailFactor, BillowsAreEmptyOutsideAndUnchangedInside) {
  for (const float noise : {0.0F, 0.5F, 1.0F}) {
    EXPECT_EQ(glsl::detail_factor({1.0F, 1.0F}, noise, 0.0F), 1.0F) << noise;
    EXPECT_EQ(glsl::detail_factor({0.0F, 1.0F}, noise, 0.0F), 0.0F) << noise;
  }
  // The surface lies farther out where the noise is high.
  EXPECT_EQ(glsl::detail_factor({0.5F, 1.0F}, 1.0F, 0.0F), 1.0F);
  EXPECT_EQ(glsl::detail_factor({0.5F, 1.0F}, 0.0F, 0.0F), 0.0F);
}

TEST(DetailFactor, FibresKeepTheirMean) {
  double sum = 0.0;
  for (int i = 0; i < 256; ++i) {
    sum += static_cast<double>(
        glsl::detail_factor({1.0F, -0.7F}, static_cast<float>(i) / 255.0F, 0.0F));
  }
  EXPECT_NEAR(sum / 256.0, 1.0, 1e-5);
  EXPECT_LT(glsl::detail_factor({1.0F, -0.7F}, 0.0F, 0.0F), 0.6F);
}

TEST(DetailFactor, WhatIsFadedHasTheMeanOfWhatIsNot) {
  // Noise that is faded to its mean has the value 1/2 everywhere. It no longer moves the surface,
  // which becomes as wide as the distance that the noise would move it.
  for (const float profile : {0.1F, 0.3F, 0.5F, 0.6F, 0.9F}) {
    double mean = 0.0;
    for (int i = 0; i < 256; ++i) {
      mean += static_cast<double>(glsl::detail_factor(
                  {profile, 1.0F}, (static_cast<float>(i) + 0.5F) / 256.0F, 0.0F)) /
              256.0;
    }
    EXPECT_NEAR(static_cast<double>(glsl::detail_factor({profile, 1.0F}, 0.5F, 1.0F)), mean, 0.06)
        << profile;
  }
}

TEST(DetailWarp, IsNoneAtTheFacesOfEmptySpace) {
  EXPECT_EQ(glsl::detail_warp_share(0.0F, 1.0F), 0.0F);
  EXPECT_EQ(glsl::detail_warp_share(1.0F, -1.0F), 1.0F);
  EXPECT_GT(glsl::detail_warp_share(1.0F, 0.0F), 0.0F);
}

TEST(DetailDrift, GoesWithTheWindAndNeverJumps) {
  constexpr double kTile_m = 12e3;  // tile size for a grid spacing of 500 m
  const double rounded_by = 0.5 * kTile_m / 10800.0;
  const glm::dvec2 wind(12.0, -4.0);
  for (double time_s = -20000.0; time_s < 40000.0; time_s += 60.0) {
    const glm::dvec2 here = DetailDrift_m(wind, time_s, kTile_m);
    const glm::dvec2 moved = DetailDrift_m(wind, time_s + 60.0, kTile_m) - here;
    // The tile repeats, so a movement by whole tiles is invisible.
    const glm::dvec2 seen = moved - kTile_m * glm::round(moved / kTile_m);
    EXPECT_NEAR(seen.x, 60.0 * wind.x, 60.0 * rounded_by) << time_s;
    EXPECT_NEAR(seen.y, 60.0 * wind.y, 60.0 * rounded_by) << time_s;
  }
  EXPECT_EQ(DetailDrift_m(glm::dvec2(0.0), 1234.0, kTile_m), glm::dvec2(0.0));
}

TEST(Fibres, LieAlongTheShear) {
  const glm::dmat3 fibres = FibresAlong({6.0, 8.0});
  const double along = glm::length(fibres * glm::dvec3(0.6, 0.8, 0.0));
  const double across = glm::length(fibres * glm::dvec3(-0.8, 0.6, 0.0));
  EXPECT_NEAR(along, 1.0 / 6.0, 1e-12);  // along the fibres the noise changes slowly
  EXPECT_NEAR(across, 1.0 / 0.7, 1e-12);
  EXPECT_EQ(FibresAlong({0.0, 0.0}), FibresAlong({5.0, 0.0}));
}

}  // namespace
}  // namespace thunderhead::physics
