// Mie theory: a plane wave scattered by a homogeneous sphere. The notation is that of Bohren and
// Huffman 1983, chapter 4: x = 2 pi r / wavelength, and m = n + i k is the refractive index
// relative to the surroundings. The code uses double precision and is tested for x from 0.001 to
// 10000.
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

namespace thunderhead::physics {

// Cross sections divided by the geometric cross section pi r^2. `back` is the radar backscattering
// efficiency.
struct MieEfficiencies {
  double extinction = 0.0;
  double scattering = 0.0;
  double back = 0.0;
  double asymmetry = 0.0;  // the mean cosine of the scattering angle
};

// The amplitudes perpendicular (s1) and parallel (s2) to the scattering plane.
struct MieAmplitudes {
  std::complex<double> s1;
  std::complex<double> s2;
};

// The Mie series of one sphere.
class MieSeries {
 public:
  // `x` must be above 0, and the imaginary part of `m` 0 or more.
  MieSeries(double x, std::complex<double> m);

  MieEfficiencies Efficiencies() const;  // eq. 4.61, 4.62, 4.82; asymmetry from p. 120

  MieAmplitudes Amplitudes(double mu) const;  // eq. 4.74

  // Adds factor (|s1|^2 + |s2|^2) / 2 at each cosine to `sums`. One call with all cosines is much
  // faster than many calls.
  void AddIntensities(const std::vector<double>& cosines, double factor,
                      std::vector<double>& sums) const;

  std::size_t terms() const { return a_.size(); }

 private:
  double x_;
  std::vector<std::complex<double>> a_;  // a_[0] is a_1
  std::vector<std::complex<double>> b_;
};

}  // namespace thunderhead::physics
