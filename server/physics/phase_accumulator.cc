#include "physics/phase_accumulator.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "physics/phase_integrals.h"

namespace thunderhead::physics {
namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;

}  // namespace

std::vector<double> AngleGrid(const std::vector<GridSpan>& spans) {
  std::vector<double> angles = {0.0};
  for (const GridSpan& span : spans) {
    const double start = angles.back();
    const int steps = static_cast<int>(std::lround((span.end_deg - start) / span.step_deg));
    THUNDERHEAD_CHECK(steps > 0 && std::abs(start + steps * span.step_deg - span.end_deg) < 1e-9,
                      absl::StrCat(span.end_deg, " degrees by ", span.step_deg));
    for (int i = 1; i < steps; ++i) angles.push_back(start + i * span.step_deg);
    angles.push_back(span.end_deg);
  }
  THUNDERHEAD_CHECK(angles.back() == 180.0, absl::StrCat(angles.back()));
  return angles;
}

PhaseAccumulator::PhaseAccumulator(const std::vector<double>& angles_deg)
    : energies_(angles_deg.size()) {
  for (const double angle_deg : angles_deg) angles_rad_.push_back(angle_deg * kRadiansPerDegree);
}

void PhaseAccumulator::Add(double angle_rad, double energy, std::size_t channel) {
  const auto next = std::upper_bound(angles_rad_.begin() + 1, angles_rad_.end() - 1, angle_rad);
  const std::size_t i = static_cast<std::size_t>(next - angles_rad_.begin());
  const double t = std::clamp(
      (angle_rad - angles_rad_[i - 1]) / (angles_rad_[i] - angles_rad_[i - 1]), 0.0, 1.0);
  energies_[i - 1][channel] += (1.0 - t) * energy;
  energies_[i][channel] += t * energy;
  energy_[channel] += energy;
}

void PhaseAccumulator::Add(const PhaseAccumulator& other, const PhaseRgb& factor) {
  THUNDERHEAD_CHECK(other.energies_.size() == energies_.size(),
                    absl::StrCat(other.energies_.size(), " and ", energies_.size()));
  for (std::size_t c = 0; c < kPhaseChannels; ++c) {
    for (std::size_t i = 0; i < energies_.size(); ++i) {
      energies_[i][c] += factor[c] * other.energies_[i][c];
    }
    energy_[c] += factor[c] * other.energy_[c];
  }
}

std::vector<PhaseRgb> PhaseAccumulator::Values() const {
  std::vector<PhaseRgb> values(energies_.size());
  for (std::size_t i = 0; i < energies_.size(); ++i) {
    // Each angle represents a share of the sphere. It is the mean over the sphere of a function
    // that is 1 at this angle and falls linearly to 0 at the two neighbouring angles.
    double share = 0.0;
    if (i > 0) share += ShareOf({angles_rad_[i - 1], angles_rad_[i], 0.0, 1.0});
    if (i + 1 < energies_.size()) share += ShareOf({angles_rad_[i], angles_rad_[i + 1], 1.0, 0.0});
    for (std::size_t c = 0; c < kPhaseChannels; ++c) {
      values[i][c] = energies_[i][c] / (energy_[c] * share);
    }
  }
  return values;
}

AngleQuadrature QuadratureOf(const std::vector<double>& angles_deg, int order) {
  const GaussLegendre gauss(order);
  AngleQuadrature quadrature;
  for (std::size_t i = 0; i + 1 < angles_deg.size(); ++i) {
    const double half = 0.5 * (angles_deg[i + 1] - angles_deg[i]) * kRadiansPerDegree;
    const double middle = 0.5 * (angles_deg[i + 1] + angles_deg[i]) * kRadiansPerDegree;
    for (std::size_t k = 0; k < gauss.points.size(); ++k) {
      const double angle = middle + half * gauss.points[k];
      quadrature.angles_rad.push_back(angle);
      quadrature.weights.push_back(half * gauss.weights[k] * std::sin(angle));
    }
  }
  return quadrature;
}

GaussLegendre::GaussLegendre(int order) {
  for (int i = 0; i < order; ++i) {
    // Newton's method finds the zeros of the Legendre polynomial. It starts from Tricomi's estimate
    // of the i-th zero.
    double x = -std::cos(std::numbers::pi * (i + 0.75) / (order + 0.5));
    double slope = 1.0;
    for (int step = 0; step < 20; ++step) {
      double previous = 1.0;
      double value = x;
      for (int n = 2; n <= order; ++n) {
        const double next = ((2 * n - 1) * x * value - (n - 1) * previous) / n;
        previous = value;
        value = next;
      }
      slope = order * (x * value - previous) / (x * x - 1.0);
      const double change = value / slope;
      x -= change;
      if (std::abs(change) < 1e-15) break;
    }
    points.push_back(x);
    weights.push_back(2.0 / ((1.0 - x * x) * slope * slope));
  }
}

}  // namespace thunderhead::physics
