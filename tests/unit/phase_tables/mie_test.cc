#include "physics/mie.h"

#include <cmath>
#include <numbers>

#include "gtest/gtest.h"
#include "physics/phase_accumulator.h"

namespace thunderhead::physics {
namespace {

using Complex = std::complex<double>;

// The values are from Wiscombe 1979 (NCAR/TN-140+STR), test cases of MIEV0.
TEST(Mie, PublishedEfficiencies) {
  const struct {
    Complex m;
    double x, scattering, asymmetry;
  } cases[] = {
      {{0.75, 0.0}, 10.0, 2.232265, 0.896473},     {{0.75, 0.0}, 1000.0, 1.997908, 0.844944},
      {{1.33, 1e-5}, 1.0, 0.093923, 0.184517},     {{1.33, 1e-5}, 100.0, 2.096594, 0.868959},
      {{1.33, 1e-5}, 10000.0, 1.723857, 0.907840}, {{1.5, 1.0}, 0.055, 0.000011, 0.000491},
      {{1.5, 1.0}, 1.0, 0.663454, 0.192136},       {{1.5, 1.0}, 100.0, 1.283697, 0.850252},
      {{1.5, 1.0}, 10000.0, 1.236575, 0.846309},   {{10.0, 10.0}, 1.0, 2.049405, -0.110664},
      {{10.0, 10.0}, 100.0, 1.836785, 0.556215},   {{10.0, 10.0}, 10000.0, 1.795393, 0.548194},
  };
  for (const auto& expected : cases) {
    const MieEfficiencies q = MieSeries(expected.x, expected.m).Efficiencies();
    // The tolerances match the number of printed digits.
    EXPECT_NEAR(q.scattering, expected.scattering, 1e-6) << expected.m << " " << expected.x;
    EXPECT_NEAR(q.asymmetry, expected.asymmetry, 1e-6) << expected.m << " " << expected.x;
  }
}

TEST(Mie, PublishedExtinctionWithoutAbsorption) {
  EXPECT_NEAR(MieSeries(10.0, 1.5).Efficiencies().extinction, 2.8820, 5e-5);
  EXPECT_NEAR(MieSeries(100.0, 1.5).Efficiencies().extinction, 2.0944, 5e-5);
  EXPECT_NEAR(MieSeries(1000.0, 1.5).Efficiencies().extinction, 2.0139, 5e-5);
  EXPECT_NEAR(MieSeries(5000.0, 1.5).Efficiencies().extinction, 2.0086, 5e-5);
  EXPECT_NEAR(MieSeries(1.0, {1.5, 1.0}).Efficiencies().extinction, 2.336321, 1e-6);
}

// The example is from Bohren and Huffman 1983, appendix A: a sphere of radius 0.525 um, m = 1.55,
// at 0.6328 um.
TEST(Mie, BohrenAndHuffmansSample) {
  const double x = 2.0 * std::numbers::pi * 0.525 / 0.6328;
  const MieEfficiencies q = MieSeries(x, 1.55).Efficiencies();
  EXPECT_NEAR(q.extinction, 3.10543, 5e-6);
  EXPECT_NEAR(q.scattering, 3.10543, 5e-6);
  EXPECT_NEAR(q.back, 2.92534, 5e-6);
}

// The amplitudes are Wiscombe's for m = 1.5 + i, x = 1. The imaginary parts there have the opposite
// sign.
TEST(Mie, PublishedAmplitudes) {
  const struct {
    double angle_deg;
    Complex s1, s2;
  } cases[] = {
      {0.0, {0.584080, -0.190515}, {0.584080, -0.190515}},
      {30.0, {0.565702, -0.187200}, {0.500161, -0.145611}},
      {90.0, {0.456340, -0.167167}, {0.0362285, 0.0618265}},
      {150.0, {0.362157, -0.149391}, {-0.305682, 0.143846}},
      {180.0, {0.348844, -0.146829}, {-0.348844, 0.146829}},
  };
  const MieSeries series(1.0, {1.5, 1.0});
  for (const auto& expected : cases) {
    const MieAmplitudes s =
        series.Amplitudes(std::cos(expected.angle_deg * std::numbers::pi / 180.0));
    EXPECT_NEAR(std::abs(s.s1 - expected.s1), 0.0, 2e-6) << expected.angle_deg;
    EXPECT_NEAR(std::abs(s.s2 - expected.s2), 0.0, 2e-6) << expected.angle_deg;
  }
}

TEST(Mie, RayleighLimit) {
  const double x = 0.01;
  const Complex m(1.33, 0.0);
  const MieEfficiencies q = MieSeries(x, m).Efficiencies();
  const double polarizability = std::norm((m * m - 1.0) / (m * m + 2.0));
  // The next term of the series is of relative size x^2.
  EXPECT_NEAR(q.scattering / (8.0 / 3.0 * std::pow(x, 4) * polarizability), 1.0, 2e-4);
  EXPECT_NEAR(q.asymmetry, 0.0, 1e-4);
  std::vector<double> intensities(3);
  MieSeries(x, m).AddIntensities({1.0, 0.5, 0.0}, 1.0, intensities);
  EXPECT_NEAR(intensities[1] / intensities[0], (1.0 + 0.25) / 2.0, 2e-4);
  EXPECT_NEAR(intensities[2] / intensities[0], 0.5, 2e-4);
}

TEST(Mie, OpticalTheoremAndBackScatter) {
  for (const double x : {0.3, 7.0, 150.0, 4000.0}) {
    const MieSeries series(x, {1.333, 2e-4});
    const MieEfficiencies q = series.Efficiencies();
    EXPECT_NEAR(4.0 / (x * x) * series.Amplitudes(1.0).s1.real() / q.extinction, 1.0, 1e-9) << x;
    EXPECT_NEAR(4.0 / (x * x) * std::norm(series.Amplitudes(-1.0).s1) / q.back, 1.0, 1e-6) << x;
    EXPECT_GT(q.extinction, q.scattering);
  }
}

// The intensity integrated over all angles is the scattering efficiency, and its first moment is g.
TEST(Mie, IntensityIntegratesToTheSeries) {
  const double x = 60.0;
  const MieSeries series(x, 1.333);
  std::vector<double> angles_deg;
  for (int i = 0; i <= 360; ++i) angles_deg.push_back(0.5 * i);
  const AngleQuadrature quadrature = QuadratureOf(angles_deg, 4);
  std::vector<double> cosines;
  for (const double angle : quadrature.angles_rad) cosines.push_back(std::cos(angle));
  std::vector<double> intensities(cosines.size());
  series.AddIntensities(cosines, 1.0, intensities);
  double sum = 0.0;
  double moment = 0.0;
  for (std::size_t i = 0; i < cosines.size(); ++i) {
    sum += quadrature.weights[i] * intensities[i];
    moment += quadrature.weights[i] * intensities[i] * cosines[i];
  }
  const MieEfficiencies q = series.Efficiencies();
  EXPECT_NEAR(2.0 / (x * x) * sum, q.scattering, 1e-9);
  EXPECT_NEAR(moment / sum, q.asymmetry, 1e-9);
  // The blocks of angles must agree with the plain sum at every angle.
  for (std::size_t i = 0; i < cosines.size(); i += 97) {
    const MieAmplitudes s = series.Amplitudes(cosines[i]);
    const double plain = 0.5 * (std::norm(s.s1) + std::norm(s.s2));
    EXPECT_NEAR(intensities[i] / plain, 1.0, 1e-9) << i;
  }
}

}  // namespace
}  // namespace thunderhead::physics
