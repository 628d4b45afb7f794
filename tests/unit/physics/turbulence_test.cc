// Tests of turbulence tiles, by which a field is multiplied. They check the properties on which
// this multiplication relies.
#include "physics/turbulence.h"

#include <algorithm>
#include <cmath>

#include "gtest/gtest.h"

namespace thunderhead::physics {
namespace {

// Returns the mean by Gauss's rule with two points per axis between neighbouring texels. It is
// exact, because the noise there is quadratic along each axis.
double MeanOf(const TurbulenceTile& tile) {
  const double gauss = 0.5 / std::sqrt(3.0);
  double sum = 0.0;
  for (std::size_t i = 0; i < 8 * tile.texels.size(); ++i) {
    const auto side = static_cast<std::size_t>(2 * tile.side);
    const glm::ivec3 at(i % side, i / side % side, i / side / side);
    const glm::dvec3 between = glm::dvec3(at / 2) + 1.0 + (2.0 * glm::dvec3(at % 2) - 1.0) * gauss;
    sum += TurbulenceAt(tile, between / static_cast<double>(tile.side));
  }
  return sum / (8.0 * static_cast<double>(tile.texels.size()));
}

// Returns the FNV-1a hash with 64 bits.
std::uint64_t HashOf(const TurbulenceTile& tile) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const std::uint8_t texel : tile.texels) hash = (hash ^ texel) * 0x100000001b3U;
  return hash;
}

class Turbulence : public testing::TestWithParam<int> {};

TEST_P(Turbulence, KeepsTheMean) {
  // The tile's scale is a float, which has a relative precision of 6e-8.
  EXPECT_NEAR(MeanOf(MakeTurbulence(GetParam(), 1)), 1.0, 2e-7);
}

TEST_P(Turbulence, LeavesAThirdClear) {
  const TurbulenceTile tile = MakeTurbulence(GetParam(), 1);
  const auto clear = std::count(tile.texels.begin(), tile.texels.end(), 0);
  // Rounding to 8 bits clears a little more.
  EXPECT_NEAR(static_cast<double>(clear) / static_cast<double>(tile.texels.size()), 1.0 / 3, 0.02);
}

TEST_P(Turbulence, RepeatsWithoutASeam) {
  const TurbulenceTile tile = MakeTurbulence(GetParam(), 7);
  const auto side = static_cast<std::size_t>(tile.side);
  // The steps across the seam are like the steps inside. Their mean squares agree within the
  // accuracy of 64^2 samples, a few percent.
  double across = 0.0;
  double inside = 0.0;
  for (std::size_t row = 0; row < side * side; ++row) {
    const std::uint8_t* texels = tile.texels.data() + row * side;
    across += std::pow(texels[0] - texels[side - 1], 2);
    inside += std::pow(texels[side / 2] - texels[side / 2 - 1], 2);
  }
  EXPECT_NEAR(across / inside, 1.0, 0.25);
}

INSTANTIATE_TEST_SUITE_P(Octaves, Turbulence, testing::Range(1, kMaxTurbulenceOctaves + 1));

TEST(Turbulence, IsTheSameOnEveryMachine) {
  // The hashes are from the first run. All arithmetic is in integers, so any difference is an
  // error.
  EXPECT_EQ(HashOf(MakeTurbulence(3, 1)), 71110320420497725U);
  EXPECT_EQ(HashOf(MakeTurbulence(4, 12345)), 16746745217059003725U);
}

TEST(Turbulence, SeedsGiveOtherTiles) {
  EXPECT_NE(MakeTurbulence(2, 1).texels, MakeTurbulence(2, 2).texels);
}

// Returns the mean square difference over a sixteenth of the first wavelength, as a share of the
// variance.
double RoughnessOf(const TurbulenceTile& tile) {
  const double step = 1.0 / (16 * TurbulenceTile::kWaves);
  double difference = 0.0;
  double variance = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const glm::dvec3 place(i * 0.137, i * 0.251, i * 0.377);
    const double here = TurbulenceAt(tile, place);
    difference += std::pow(TurbulenceAt(tile, place + glm::dvec3(step, 0.0, 0.0)) - here, 2);
    variance += std::pow(here - 1.0, 2);
  }
  return difference / variance;
}

TEST(Turbulence, OctavesAddFinerStructure) {
  double coarser = RoughnessOf(MakeTurbulence(1, 1));
  for (int octaves = 2; octaves <= kMaxTurbulenceOctaves; ++octaves) {
    const double roughness = RoughnessOf(MakeTurbulence(octaves, 1));
    EXPECT_GT(roughness, coarser) << octaves;
    coarser = roughness;
  }
}

TEST(Turbulence, ItsRootIsLinearBetweenTexelsAndWrapsAround) {
  const TurbulenceTile tile = MakeTurbulence(1, 3);
  const auto full = std::max_element(tile.texels.begin(), tile.texels.end()) - tile.texels.begin();
  const glm::dvec3 index(full % tile.side, full / tile.side % tile.side,
                         full / tile.side / tile.side);
  const double texel = 1.0 / tile.side;
  const glm::dvec3 middle = (index + 0.5) * texel;
  EXPECT_NEAR(TurbulenceAt(tile, middle), tile.value_of_full, 1e-5);
  const double next = tile.texels[static_cast<std::size_t>(full) + 1] / 255.0;
  EXPECT_NEAR(TurbulenceAt(tile, middle + glm::dvec3(0.5 * texel, 0.0, 0.0)),
              std::pow(0.5 * (1.0 + next), 2) * tile.value_of_full, 1e-5);
  const glm::dvec3 place(0.3, 0.7, 0.1);
  EXPECT_NEAR(TurbulenceAt(tile, place), TurbulenceAt(tile, place + glm::dvec3(-3.0, 2.0, 5.0)),
              1e-6);
}

}  // namespace
}  // namespace thunderhead::physics
