// Man's noise: a sum of octaves of smoothed lattice noise (P. Man, "Generating and Real-Time
// Rendering of Clouds", eq. 1-7). These are pure functions of numbers. The result has the same bits
// on every machine.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace thunderhead::clouds {

enum class NoiseInterpolation { kLinear, kCosine, kCubic };

struct NoiseParameters {
  int octaves = 4;           // Z of eq. 1
  double persistence = 0.5;  // s: ratio of successive octaves' amplitudes
  NoiseInterpolation interpolation = NoiseInterpolation::kCosine;
  std::uint64_t seed = 0;  // with 0 the noise is the paper's; other seeds shift the lattice of each
                           // octave
};

// Computes g of eq. 2, in (-1, 1]. The operators of eq. 2 are illegible in the scanned paper. This
// function uses the well-known 32-bit integer noise with the same constants, where n = (m << 13) ^
// m. `shift` is added to m.
double LatticeNoise(std::int32_t x, std::int32_t y, std::int32_t z, std::uint32_t shift = 0);

// Computes f of eq. 3, the weighted mean of g over 27 lattice points. These are the point itself
// and the 26 points around it. The weight of the point itself is 9/18. The weights of the others
// are 4/(6 18) for 6 faces, 3/(12 18) for 12 edges, 2/(8 18) for 8 corners.
double SmoothNoise(std::int32_t x, std::int32_t y, std::int32_t z, std::uint32_t shift = 0);

// Returns the weights of the lattice values at -1, 0, 1 and 2 for interpolation at the position
// `fraction`, 0 to 1. They follow eq. 4, 5 or 6.
std::array<double, 4> InterpolationWeights(NoiseInterpolation interpolation, double fraction);

// Computes the noise of eq. 1 at one point. Coordinates are in units of the coarsest lattice. It is
// slow but simple, and the tests compare NoiseSlices with it.
double Noise(const NoiseParameters& parameters, double x, double y, double z);

// The positions of cells along an axis, in units of the coarsest lattice.
struct NoiseAxis {
  double first = 0.0;
  double step = 1.0;
  int count = 1;
};

// Computes the noise of eq. 1 on horizontal slices of a grid. Each lattice value is computed only
// once, when its lattice plane is first needed.
class NoiseSlices {
 public:
  NoiseSlices(const NoiseParameters& parameters, const NoiseAxis& x, const NoiseAxis& y);

  // Returns the values of the slice at height `z`, x fastest. Calls are fastest if `z` increases
  // from call to call.
  const std::vector<double>& At(double z);

 private:
  struct Tap {
    std::int32_t first = 0;  // lattice index of the first of the four weights
    std::array<double, 4> weights{};
  };
  // The smoothed lattice values of one horizontal lattice plane.
  struct Plane {
    std::int32_t z = 0;
    bool filled = false;
    std::vector<double> values;
  };
  struct Octave {
    double frequency = 1.0;
    double amplitude = 1.0;
    std::uint32_t shift = 0;
    std::vector<Tap> x;
    std::vector<Tap> y;
    std::int32_t low_x = 0;
    std::int32_t low_y = 0;
    std::size_t width = 0;
    std::size_t height = 0;
    std::array<Plane, 4> planes;  // the index of a plane is its z modulo 4
  };

  std::vector<Tap> TapsOf(const NoiseAxis& axis, double frequency) const;
  static const std::vector<double>& PlaneAt(Octave& octave, std::int32_t z);
  void Add(Octave& octave, double z);

  NoiseInterpolation interpolation_;
  std::vector<Octave> octaves_;
  std::vector<double> slice_;
  std::vector<double> mixed_;
  std::vector<double> row_;
};

}  // namespace thunderhead::clouds
