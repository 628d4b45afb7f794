#include "clouds/noise.h"

#include <cmath>

#include "clouds/repeatable_math.h"

namespace thunderhead::clouds {
namespace {

// Returns the shift of the lattice for a seed and octave. It is 0 for seed 0.
std::uint32_t ShiftOf(std::uint64_t seed, int octave) {
  if (seed == 0) return 0;
  std::uint64_t z = seed + 0x9e3779b97f4a7c15U * (static_cast<std::uint64_t>(octave) + 1U);
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
  return static_cast<std::uint32_t>(z >> 32U);
}

}  // namespace

double LatticeNoise(std::int32_t x, std::int32_t y, std::int32_t z, std::uint32_t shift) {
  const std::uint32_t m = static_cast<std::uint32_t>(x) + 57U * static_cast<std::uint32_t>(y) +
                          57U * 57U * static_cast<std::uint32_t>(z) + shift;
  const std::uint32_t n = (m << 13U) ^ m;
  const std::uint32_t mixed = n * (n * n * 15731U + 789221U) + 1376312589U;
  return 1.0 - static_cast<double>(mixed & 0x7fffffffU) / 1073741824.0;
}

double SmoothNoise(std::int32_t x, std::int32_t y, std::int32_t z, std::uint32_t shift) {
  // The index is the number of coordinates in which a neighbour differs: centre, faces, edges,
  // corners.
  constexpr std::array<double, 4> kWeights = {9.0 / 18.0, 4.0 / (6.0 * 18.0), 3.0 / (12.0 * 18.0),
                                              2.0 / (8.0 * 18.0)};
  std::array<double, 4> sums{};
  for (std::int32_t dz = -1; dz <= 1; ++dz) {
    for (std::int32_t dy = -1; dy <= 1; ++dy) {
      for (std::int32_t dx = -1; dx <= 1; ++dx) {
        const std::int32_t differ = dx * dx + dy * dy + dz * dz;
        sums[static_cast<std::size_t>(differ)] += LatticeNoise(x + dx, y + dy, z + dz, shift);
      }
    }
  }
  return sums[0] * kWeights[0] + sums[1] * kWeights[1] + sums[2] * kWeights[2] +
         sums[3] * kWeights[3];
}

std::array<double, 4> InterpolationWeights(NoiseInterpolation interpolation, double fraction) {
  const double x = fraction;
  switch (interpolation) {
    case NoiseInterpolation::kLinear:
      return {0.0, 1.0 - x, x, 0.0};
    case NoiseInterpolation::kCosine: {
      const double share = 0.5 * (1.0 - CosineOfDegrees(180.0 * x));
      return {0.0, 1.0 - share, share, 0.0};
    }
    case NoiseInterpolation::kCubic:
      break;
  }
  // These are the terms P x^3 + Q x^2 + R x + S of eq. 6, rearranged as factors of the four lattice
  // values.
  const double square = x * x;
  const double cube = square * x;
  return {2.0 * square - cube - x, cube - 2.0 * square + 1.0, square + x - cube, cube - square};
}

double Noise(const NoiseParameters& parameters, double x, double y, double z) {
  double sum = 0.0;
  double amplitude = 1.0;
  double frequency = 1.0;
  for (int i = 0; i < parameters.octaves; ++i) {
    const std::array<double, 3> place = {x * frequency, y * frequency, z * frequency};
    std::array<std::int32_t, 3> cell{};
    std::array<std::array<double, 4>, 3> weights{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double floor = std::floor(place[axis]);
      cell[axis] = static_cast<std::int32_t>(floor);
      weights[axis] = InterpolationWeights(parameters.interpolation, place[axis] - floor);
    }
    const std::uint32_t shift = ShiftOf(parameters.seed, i);
    double value = 0.0;
    for (std::int32_t c = 0; c < 64; ++c) {
      const std::int32_t dx = c % 4;
      const std::int32_t dy = c / 4 % 4;
      const std::int32_t dz = c / 16;
      const double weight = weights[0][static_cast<std::size_t>(dx)] *
                            weights[1][static_cast<std::size_t>(dy)] *
                            weights[2][static_cast<std::size_t>(dz)];
      if (weight == 0.0) continue;
      value += weight * SmoothNoise(cell[0] + dx - 1, cell[1] + dy - 1, cell[2] + dz - 1, shift);
    }
    sum += amplitude * value;
    amplitude *= parameters.persistence;
    frequency *= 2.0;
  }
  return std::abs(sum);
}

NoiseSlices::NoiseSlices(const NoiseParameters& parameters, const NoiseAxis& x, const NoiseAxis& y)
    : interpolation_(parameters.interpolation) {
  double amplitude = 1.0;
  double frequency = 1.0;
  for (int i = 0; i < parameters.octaves; ++i) {
    Octave octave;
    octave.frequency = frequency;
    octave.amplitude = amplitude;
    octave.shift = ShiftOf(parameters.seed, i);
    octave.x = TapsOf(x, frequency);
    octave.y = TapsOf(y, frequency);
    octave.low_x = octave.x.front().first;
    octave.low_y = octave.y.front().first;
    octave.width = static_cast<std::size_t>(octave.x.back().first - octave.low_x) + 4;
    octave.height = static_cast<std::size_t>(octave.y.back().first - octave.low_y) + 4;
    octaves_.push_back(std::move(octave));
    amplitude *= parameters.persistence;
    frequency *= 2.0;
  }
  slice_.resize(static_cast<std::size_t>(x.count) * static_cast<std::size_t>(y.count));
}

std::vector<NoiseSlices::Tap> NoiseSlices::TapsOf(const NoiseAxis& axis, double frequency) const {
  std::vector<Tap> taps;
  for (int i = 0; i < axis.count; ++i) {
    const double place = (axis.first + axis.step * i) * frequency;
    const double floor = std::floor(place);
    taps.push_back({static_cast<std::int32_t>(floor) - 1,
                    InterpolationWeights(interpolation_, place - floor)});
  }
  return taps;
}

const std::vector<double>& NoiseSlices::PlaneAt(Octave& octave, std::int32_t z) {
  Plane& plane = octave.planes[static_cast<std::uint32_t>(z) % 4U];
  if (plane.filled && plane.z == z) return plane.values;
  plane.z = z;
  plane.filled = true;
  plane.values.clear();
  plane.values.reserve(octave.width * octave.height);
  for (std::size_t y = 0; y < octave.height; ++y) {
    for (std::size_t x = 0; x < octave.width; ++x) {
      plane.values.push_back(SmoothNoise(octave.low_x + static_cast<std::int32_t>(x),
                                         octave.low_y + static_cast<std::int32_t>(y), z,
                                         octave.shift));
    }
  }
  return plane.values;
}

// Adds the octave at height `z`. Interpolates between planes, then rows, then columns.
void NoiseSlices::Add(Octave& octave, double z) {
  const double place = z * octave.frequency;
  const double floor = std::floor(place);
  const std::array<double, 4> weights = InterpolationWeights(interpolation_, place - floor);
  mixed_.assign(octave.width * octave.height, 0.0);
  for (std::size_t i = 0; i < 4; ++i) {
    if (weights[i] == 0.0) continue;
    const std::int32_t at = static_cast<std::int32_t>(floor) - 1 + static_cast<std::int32_t>(i);
    const std::vector<double>& plane = PlaneAt(octave, at);
    for (std::size_t c = 0; c < plane.size(); ++c) mixed_[c] += weights[i] * plane[c];
  }
  double* to = slice_.data();
  for (const Tap& y : octave.y) {
    const auto first_row = static_cast<std::size_t>(y.first - octave.low_y);
    row_.assign(octave.width, 0.0);
    for (std::size_t i = 0; i < 4; ++i) {
      const double* from = mixed_.data() + (first_row + i) * octave.width;
      for (std::size_t x = 0; x < octave.width; ++x) row_[x] += y.weights[i] * from[x];
    }
    for (const Tap& x : octave.x) {
      const double* from = row_.data() + (x.first - octave.low_x);
      *to++ += octave.amplitude * (x.weights[0] * from[0] + x.weights[1] * from[1] +
                                   x.weights[2] * from[2] + x.weights[3] * from[3]);
    }
  }
}

const std::vector<double>& NoiseSlices::At(double z) {
  slice_.assign(slice_.size(), 0.0);
  for (Octave& octave : octaves_) Add(octave, z);
  for (double& value : slice_) value = std::abs(value);
  return slice_;
}

}  // namespace thunderhead::clouds
