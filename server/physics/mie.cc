#include "physics/mie.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "base/status.h"

namespace thunderhead::physics {
namespace {

using Complex = std::complex<double>;

// Number of angles in a block. It is so small that the recurrences of the block fit into the
// first-level cache.
constexpr std::size_t kBlock = 256;

// Returns the logarithmic derivative D_n(z) of psi_n for n = 0 ... count, by downward recurrence
// (Bohren and Huffman 1983, eq. 4.89). The recurrence is stable for any absorption. It starts from
// the value 0. The error of this start vanishes before n = |z| if the start index exceeds |z| by a
// few times the cube root of |z|. With the usual excess of 15, an error of 1e-5 would remain in the
// efficiencies.
std::vector<Complex> LogarithmicDerivatives(Complex z, std::size_t count) {
  const double turning = std::abs(z);
  const auto above = static_cast<std::size_t>(turning + 8.0 * std::cbrt(turning) + 16.0);
  const std::size_t top = std::max(count + 16, above);
  std::vector<Complex> d(count + 1);
  Complex value = 0.0;
  for (std::size_t n = top; n > 0; --n) {
    const Complex ratio = static_cast<double>(n) / z;
    value = ratio - 1.0 / (value + ratio);
    if (n - 1 <= count) d[n - 1] = value;
  }
  return d;
}

// Returns psi_n(x) for n = 0 ... count. The upward recurrence is used while n < x. For larger n it
// would lose all digits, so the ratios psi_n / psi_n-1 of the downward recurrence are used. These
// ratios are finite there, because psi_n(x) has no zero at 0 < x < n.
std::vector<double> PsiFunctions(double x, std::size_t count) {
  const std::size_t top = std::max(count, static_cast<std::size_t>(x)) + 40;
  std::vector<double> ratios(count + 1);
  double ratio = x / static_cast<double>(2 * top + 1);
  for (std::size_t n = top; n > 0; --n) {
    if (n <= count) ratios[n] = ratio;
    ratio = 1.0 / (static_cast<double>(2 * n - 1) / x - ratio);
  }
  std::vector<double> psi(count + 1);
  psi[0] = std::sin(x);
  // For small x, the closed form of psi_1 is a difference of nearly equal numbers and would lose
  // digits.
  psi[1] = x < 0.1 ? psi[0] * ratios[1] : psi[0] / x - std::cos(x);
  for (std::size_t n = 2; n <= count; ++n) {
    psi[n] = static_cast<double>(n) < x
                 ? static_cast<double>(2 * n - 1) / x * psi[n - 1] - psi[n - 2]
                 : psi[n - 1] * ratios[n];
  }
  return psi;
}

}  // namespace

MieSeries::MieSeries(double x, Complex m) : x_(x) {
  THUNDERHEAD_CHECK(x > 0.0 && m.imag() >= 0.0, absl::StrCat(x, ", ", m.imag()));
  // The number of terms follows Wiscombe 1980 (Appl. Opt. 19, 1505), eq. 6.
  const auto count = static_cast<std::size_t>(x + 4.05 * std::cbrt(x) + 2.0);
  const std::vector<Complex> d = LogarithmicDerivatives(m * x, count);
  const std::vector<double> psi = PsiFunctions(x, count);
  double chi_before = -std::sin(x);
  double chi = std::cos(x);
  for (std::size_t n = 1; n <= count; ++n) {
    const double chi_next = static_cast<double>(2 * n - 1) / x * chi - chi_before;
    const Complex xi_before(psi[n - 1], -chi);
    const Complex xi(psi[n], -chi_next);
    const double ratio = static_cast<double>(n) / x;
    const Complex electric = d[n] / m + ratio;
    const Complex magnetic = m * d[n] + ratio;
    a_.push_back((electric * psi[n] - psi[n - 1]) / (electric * xi - xi_before));  // eq. 4.88
    b_.push_back((magnetic * psi[n] - psi[n - 1]) / (magnetic * xi - xi_before));
    chi_before = chi;
    chi = chi_next;
  }
}

MieEfficiencies MieSeries::Efficiencies() const {
  double extinction = 0.0;
  double scattering = 0.0;
  double cosine = 0.0;
  Complex back = 0.0;
  for (std::size_t i = 0; i < a_.size(); ++i) {
    const double n = static_cast<double>(i + 1);
    extinction += (2.0 * n + 1.0) * (a_[i] + b_[i]).real();
    scattering += (2.0 * n + 1.0) * (std::norm(a_[i]) + std::norm(b_[i]));
    back += (2.0 * n + 1.0) * (i % 2 == 0 ? -1.0 : 1.0) * (a_[i] - b_[i]);
    cosine += (2.0 * n + 1.0) / (n * (n + 1.0)) * (a_[i] * std::conj(b_[i])).real();
    if (i + 1 < a_.size()) {
      cosine += n * (n + 2.0) / (n + 1.0) *
                (a_[i] * std::conj(a_[i + 1]) + b_[i] * std::conj(b_[i + 1])).real();
    }
  }
  const double x2 = x_ * x_;
  return {2.0 / x2 * extinction, 2.0 / x2 * scattering, std::norm(back) / x2,
          2.0 * cosine / scattering};
}

MieAmplitudes MieSeries::Amplitudes(double mu) const {
  MieAmplitudes amplitudes{};
  double pi_before = 0.0;
  double pi = 1.0;
  for (std::size_t i = 0; i < a_.size(); ++i) {
    const double n = static_cast<double>(i + 1);
    const double tau = n * mu * pi - (n + 1.0) * pi_before;  // eq. 4.47
    const double weight = (2.0 * n + 1.0) / (n * (n + 1.0));
    amplitudes.s1 += weight * (a_[i] * pi + b_[i] * tau);
    amplitudes.s2 += weight * (a_[i] * tau + b_[i] * pi);
    const double pi_next = ((2.0 * n + 1.0) * mu * pi - (n + 1.0) * pi_before) / n;
    pi_before = pi;
    pi = pi_next;
  }
  return amplitudes;
}

void MieSeries::AddIntensities(const std::vector<double>& cosines, double factor,
                               std::vector<double>& sums) const {
  // s1 + s2 and s1 - s2 are sums of (a + b)(pi + tau) and (a - b)(pi - tau). Computing these sums
  // takes half the work of s1 and s2, and they give the same intensity.
  for (std::size_t begin = 0; begin < cosines.size(); begin += kBlock) {
    const std::size_t size = std::min(kBlock, cosines.size() - begin);
    std::array<double, kBlock> mu{};
    std::array<double, kBlock> pi{};
    std::array<double, kBlock> pi_before{};
    std::array<double, kBlock> plus_re{};
    std::array<double, kBlock> plus_im{};
    std::array<double, kBlock> minus_re{};
    std::array<double, kBlock> minus_im{};
    std::copy_n(cosines.begin() + static_cast<std::ptrdiff_t>(begin), size, mu.begin());
    pi.fill(1.0);
    for (std::size_t i = 0; i < a_.size(); ++i) {
      const double n = static_cast<double>(i + 1);
      const double weight = (2.0 * n + 1.0) / (n * (n + 1.0));
      const Complex plus = weight * (a_[i] + b_[i]);
      const Complex minus = weight * (a_[i] - b_[i]);
      const double growth = (n + 1.0) / n;
      for (std::size_t j = 0; j < kBlock; ++j) {
        const double rise = mu[j] * pi[j];
        const double step = rise - pi_before[j];
        const double tau = n * step - pi_before[j];
        plus_re[j] += plus.real() * (pi[j] + tau);
        plus_im[j] += plus.imag() * (pi[j] + tau);
        minus_re[j] += minus.real() * (pi[j] - tau);
        minus_im[j] += minus.imag() * (pi[j] - tau);
        pi_before[j] = pi[j];
        pi[j] = rise + growth * step;
      }
    }
    for (std::size_t j = 0; j < size; ++j) {
      sums[begin + j] += 0.25 * factor *
                         (plus_re[j] * plus_re[j] + plus_im[j] * plus_im[j] +
                          minus_re[j] * minus_re[j] + minus_im[j] * minus_im[j]);
    }
  }
}

}  // namespace thunderhead::physics
