#include "physics/detail_tile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>

#include "base/status.h"
#include "glm/geometric.hpp"

namespace thunderhead::physics {
namespace {

constexpr std::size_t kTileSide = DetailTile::kSide;
constexpr std::size_t kTexels = kTileSide * kTileSide * kTileSide;
constexpr int kWarpOctaves = 2;
constexpr double kBillowPersistence = 0.65;
constexpr double kWarpDeviation = 0.4;  // standard deviation relative to the full displacement
constexpr double kFibreStretch = 6.0;   // stretch along the shear
constexpr double kFibreWidth = 0.7;     // width across the shear, relative to that of the billows
constexpr double kMinShear_m_per_s = 1.0;
// A divisor of a day, so that the noise does not jump at midnight.
constexpr double kDriftPeriod_s = 3.0 * 3600.0;
constexpr double kWarpInCells = 1.0;
// Larger than kWarpInCells, because a grid's cells are usually much lower than wide.
constexpr double kUpwardWarpInCells = 2.0;
constexpr double kWarpInWavelengths = 0.25;

// Adds `octaves` octaves of noise, beginning with octave number `first`. The amplitude of each
// octave is `persistence` times that of the octave before. If `billows` is true, the absolute
// values are added.
std::vector<float> Sum(int first, int octaves, double persistence, std::uint32_t seed,
                       bool billows) {
  std::vector<float> sums(kTexels, 0.0F);
  double amplitude = 1.0 / static_cast<double>(kPerlinOne * kPerlinOne * kPerlinOne);
  for (int index = first; index < first + octaves; ++index) {
    const PerlinOctave octave = MakePerlinOctave(index, DetailTile::kSide, seed);
    float* row = sums.data();
    for (int z = 0; z < DetailTile::kSide; ++z) {
      for (int y = 0; y < DetailTile::kSide; ++y, row += kTileSide) {
        AddPerlinRow(octave, y, z, [&](std::size_t texel, std::int64_t noise) {
          row[texel] += static_cast<float>(
              static_cast<double>(billows && noise < 0 ? -noise : noise) * amplitude);
        });
      }
    }
    amplitude *= persistence;
  }
  return sums;
}

// Replaces values by their ranks, scaled to 0 to 255.
void StoreRanks(const std::vector<float>& values, std::size_t channel, DetailTile* tile) {
  constexpr std::size_t kBins = 1U << 16U;
  const float largest = *std::max_element(values.begin(), values.end());
  const auto bin_of = [&](float value) {
    return static_cast<std::size_t>(value / largest * static_cast<float>(kBins - 1));
  };
  std::vector<std::size_t> below(kBins + 1, 0);
  for (const float value : values) ++below[bin_of(value) + 1];
  for (std::size_t bin = 0; bin < kBins; ++bin) below[bin + 1] += below[bin];
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t bin = bin_of(values[i]);
    const std::size_t rank = (below[bin] + below[bin + 1]) / 2;
    tile->texels[4 * i + channel] = static_cast<std::uint8_t>(rank * 256 / (kTexels + 1));
  }
}

// Stores values as bytes, after shifting their mean to 0 and scaling their standard deviation to
// kWarpDeviation.
void StoreDisplacement(const std::vector<float>& values, std::size_t channel, DetailTile* tile) {
  double mean = 0.0;
  double square = 0.0;
  for (const float value : values) {
    mean += static_cast<double>(value) / kTexels;
    square += static_cast<double>(value) * static_cast<double>(value) / kTexels;
  }
  const double scale = kWarpDeviation / std::sqrt(square - mean * mean);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double value = std::clamp((static_cast<double>(values[i]) - mean) * scale, -1.0, 1.0);
    tile->texels[4 * i + channel] =
        static_cast<std::uint8_t>(std::floor(127.5 + 127.5 * value + 0.5 * (value < 0.0)));
  }
}

}  // namespace

DetailTile MakeDetailTile(int octaves, std::uint32_t seed) {
  THUNDERHEAD_CHECK(octaves >= 1 && octaves <= kMaxDetailOctaves, std::to_string(octaves));
  DetailTile tile;
  tile.texels.resize(4 * kTexels);
  StoreRanks(Sum(0, octaves, kBillowPersistence, seed, true), 0, &tile);
  // This offset is larger than any seed of a scene, so the displacement never has the same seed as
  // the billows.
  constexpr std::uint32_t kOtherSeeds = 1U << 20U;
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    StoreDisplacement(Sum(0, kWarpOctaves, 0.5, seed + kOtherSeeds * (axis + 1), false), axis + 1,
                      &tile);
  }
  return tile;
}

std::vector<std::uint8_t> CoarserLevel(const std::vector<std::uint8_t>& texels, int side) {
  const auto fine = static_cast<std::size_t>(side);
  const std::size_t coarse = fine / 2;
  THUNDERHEAD_CHECK(side % 2 == 0 && texels.size() == 4 * fine * fine * fine, std::to_string(side));
  std::vector<std::uint16_t> sums(4 * coarse * coarse * coarse, 0);
  for (std::size_t z = 0; z < fine; ++z) {
    for (std::size_t y = 0; y < fine; ++y) {
      const std::uint8_t* row = texels.data() + 4 * (z * fine + y) * fine;
      std::uint16_t* sum = sums.data() + 4 * ((z / 2) * coarse + y / 2) * coarse;
      for (std::size_t i = 0; i < 4 * fine; ++i) {
        std::uint16_t& into = sum[i / 8 * 4 + i % 4];
        into = static_cast<std::uint16_t>(into + row[i]);
      }
    }
  }
  std::vector<std::uint8_t> means(sums.size());
  std::transform(sums.begin(), sums.end(), means.begin(),
                 [](std::uint16_t sum) { return static_cast<std::uint8_t>((sum + 4) / 8); });
  return means;
}

glm::dmat3 FibresAlong(const glm::dvec2& shear_m_per_s) {
  const glm::dvec2 along = glm::length(shear_m_per_s) > kMinShear_m_per_s
                               ? glm::normalize(shear_m_per_s)
                               : glm::dvec2(1.0, 0.0);
  const glm::dvec2 x = along / kFibreStretch;
  const glm::dvec2 y = glm::dvec2(-along.y, along.x) / kFibreWidth;
  return {{x.x, y.x, 0.0}, {x.y, y.y, 0.0}, {0.0, 0.0, 1.0 / kFibreWidth}};
}

glm::dvec2 DetailDrift_m(const glm::dvec2& wind_m_per_s, double time_s, double tile_m) {
  const double periods = time_s / kDriftPeriod_s;
  const glm::dvec2 tiles = glm::round(wind_m_per_s * kDriftPeriod_s / tile_m);
  return glm::fract(tiles * (periods - std::floor(periods))) * tile_m;
}

glm::dvec3 DetailWarp_m(const glm::dvec3& cell_m, double wavelength_m) {
  const double across_m = std::min(
      {kWarpInCells * cell_m.x, kWarpInCells * cell_m.y, kWarpInWavelengths * wavelength_m});
  return {across_m, across_m, std::min(across_m, kUpwardWarpInCells * cell_m.z)};
}

glm::dvec4 DetailNoiseAt(const DetailTile& tile, const glm::dvec3& place) {
  const glm::dvec3 texel = (place - glm::floor(place)) * static_cast<double>(kTileSide) - 0.5;
  const glm::dvec3 floor = glm::floor(texel);
  const glm::dvec3 share = texel - floor;
  const auto wrap = [](double i) {
    return static_cast<std::size_t>(static_cast<int>(i) & (DetailTile::kSide - 1));
  };
  glm::dvec4 sum(0.0);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 step(corner & 1, (corner >> 1) & 1, corner >> 2);
    const glm::dvec3 weights = glm::mix(1.0 - share, share, step);
    const std::uint8_t* at =
        tile.texels.data() +
        4 * ((wrap(floor.z + step.z) * kTileSide + wrap(floor.y + step.y)) * kTileSide +
             wrap(floor.x + step.x));
    sum += weights.x * weights.y * weights.z * glm::dvec4(at[0], at[1], at[2], at[3]);
  }
  return {sum.x / 255.0, 2.0 * sum.y / 255.0 - 1.0, 2.0 * sum.z / 255.0 - 1.0,
          2.0 * sum.w / 255.0 - 1.0};
}

}  // namespace thunderhead::physics
