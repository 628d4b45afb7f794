#include "reference/sampled_phase.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "base/status.h"
#include "physics/optics.h"

namespace thunderhead::reference {
namespace {

// Number of intervals. Diffraction peaks of millimetre drops are only 0.02 degrees wide, so nodes
// are denser towards the angle 0.
constexpr std::size_t kIntervals = 8192;

// Returns 1 - mu at node `i`. The formula avoids the cancellation in 1 - cos.
double NodeX(std::size_t i) {
  const double s = static_cast<double>(i) / kIntervals;
  const double sine = std::sin(0.5 * std::numbers::pi * s * s);
  return 2.0 * sine * sine;
}

std::size_t IntervalAt(double x) {
  const double angle = 2.0 * std::asin(std::sqrt(std::clamp(0.5 * x, 0.0, 1.0)));
  const double s = std::sqrt(angle * std::numbers::inv_pi);
  return std::min(static_cast<std::size_t>(s * kIntervals), kIntervals - 1);
}

double Interpolate(const std::vector<double>& values, std::size_t interval, double share) {
  return values[interval] + share * (values[interval + 1] - values[interval]);
}

double HenyeyGreensteinValue(double g, double mu) {
  const double base = (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - mu);
  return (1.0 - g) * (1.0 + g) / (base * std::sqrt(base));
}

// Returns the inverse of Henyey and Greenstein's cumulative distribution.
double HenyeyGreensteinSample(double g, double u) {
  // The closed form is 0 / 0 at g = 0. For |g| below 1e-4, the first-order expansion in g is exact
  // to 1e-8.
  if (std::abs(g) < 1e-4) {
    const double isotropic = 1.0 - 2.0 * u;
    return isotropic + 1.5 * g * (1.0 - isotropic * isotropic);
  }
  const double root = (1.0 - g * g) / (1.0 + g - 2.0 * g * u);
  return std::clamp((1.0 + g * g - root * root) / (2.0 * g), -1.0, 1.0);
}

}  // namespace

SampledPhase SampledPhase::HenyeyGreenstein(double asymmetry) {
  THUNDERHEAD_CHECK(std::abs(asymmetry) < 1.0, std::to_string(asymmetry));
  SampledPhase phase;
  phase.asymmetry_ = asymmetry;
  return phase;
}

SampledPhase SampledPhase::Tabulated(const Function& function) {
  return Tabulated(std::array<Function, 3>{function, {}, {}});
}

SampledPhase SampledPhase::Tabulated(const std::array<Function, 3>& by_color) {
  SampledPhase phase;
  phase.colored_ = static_cast<bool>(by_color[1]);
  phase.x_.resize(kIntervals + 1);
  for (std::size_t i = 0; i <= kIntervals; ++i) phase.x_[i] = NodeX(i);
  for (std::size_t color = 0; color < (phase.colored_ ? 3U : 1U); ++color) {
    for (const double x : phase.x_) phase.values_[color].push_back(by_color[color](1.0 - x));
    phase.Normalize(color);
    phase.Accumulate(color);
  }
  return phase;
}

SampledPhase SampledPhase::Of(const physics::PhaseFunction& phase) {
  if (phase.kind == physics::PhaseKind::kHenyeyGreenstein) {
    return HenyeyGreenstein(phase.asymmetry);
  }
  const auto color = [phase](int c) {
    return [phase, c](double mu) { return physics::PhaseColors(phase, mu)[c]; };
  };
  // A formula has the same values for all colours.
  if (physics::FormulaOf(phase.kind) != nullptr) return Tabulated(color(0));
  return Tabulated({color(0), color(1), color(2)});
}

void SampledPhase::Normalize(std::size_t color) {
  std::vector<double>& values = values_[color];
  double integral = 0.0;
  for (std::size_t i = 0; i < kIntervals; ++i) {
    THUNDERHEAD_CHECK(std::isfinite(values[i]) && values[i] >= 0.0, std::to_string(values[i]));
    integral += 0.5 * (values[i] + values[i + 1]) * (x_[i + 1] - x_[i]);
  }
  THUNDERHEAD_CHECK(std::isfinite(integral) && integral > 0.0, std::to_string(integral));
  for (double& value : values) value *= 2.0 / integral;
}

void SampledPhase::Accumulate(std::size_t color) {
  const std::vector<double>& density = values_[color];
  std::vector<double>& cumulative = cumulative_[color];
  cumulative.assign(kIntervals + 1, 0.0);
  for (std::size_t i = 0; i < kIntervals; ++i) {
    cumulative[i + 1] = cumulative[i] + 0.25 * (density[i] + density[i + 1]) * (x_[i + 1] - x_[i]);
  }
  for (double& value : cumulative) value /= cumulative.back();
  guide_[color].resize(kIntervals);
  std::uint32_t interval = 0;
  for (std::size_t i = 0; i < kIntervals; ++i) {
    while (cumulative[interval + 1] * kIntervals < static_cast<double>(i)) ++interval;
    guide_[color][i] = interval;
  }
}

glm::dvec3 SampledPhase::Value(double mu) const {
  if (x_.empty()) return glm::dvec3(HenyeyGreensteinValue(asymmetry_, mu));
  const double x = 1.0 - mu;
  const std::size_t interval = IntervalAt(x);
  const double share = std::clamp((x - x_[interval]) / (x_[interval + 1] - x_[interval]), 0.0, 1.0);
  const double first = Interpolate(values_[0], interval, share);
  if (!colored_) return glm::dvec3(first);
  return {first, Interpolate(values_[1], interval, share),
          Interpolate(values_[2], interval, share)};
}

double SampledPhase::Asymmetry() const {
  if (x_.empty()) return asymmetry_;
  const std::size_t colors = colored_ ? 3 : 1;
  double mean = 0.0;
  for (std::size_t color = 0; color < colors; ++color) {
    for (std::size_t i = 0; i < kIntervals; ++i) {
      const double share = cumulative_[color][i + 1] - cumulative_[color][i];
      mean += share * (1.0 - 0.5 * (x_[i] + x_[i + 1]));
    }
  }
  return mean / static_cast<double>(colors);
}

std::size_t SampledPhase::IntervalOf(double u, std::size_t color) const {
  const std::vector<double>& cumulative = cumulative_[color];
  std::size_t interval =
      guide_[color][std::min(static_cast<std::size_t>(u * kIntervals), kIntervals - 1)];
  while (interval + 1 < kIntervals && cumulative[interval + 1] < u) ++interval;
  return interval;
}

PhaseSample SampledPhase::Sample(double u, std::size_t color) const {
  if (x_.empty()) return {HenyeyGreensteinSample(asymmetry_, u), glm::dvec3(1.0)};
  const std::size_t table = colored_ ? color : 0;
  const std::size_t interval = IntervalOf(u, table);
  const double low = values_[table][interval];
  const double high = values_[table][interval + 1];
  const double width = x_[interval + 1] - x_[interval];
  const double rest = u - cumulative_[table][interval];
  // y is the root of low y + (high - low) y^2 / (2 width) = 2 rest. This form of the root avoids
  // cancellation.
  const double discriminant = low * low + 4.0 * (high - low) * rest / width;
  const double divisor = low + std::sqrt(std::max(discriminant, 0.0));
  const double y = divisor > 0.0 ? std::clamp(4.0 * rest / divisor, 0.0, width) : 0.0;
  PhaseSample sample;
  sample.mu = 1.0 - (x_[interval] + y);
  if (colored_) {
    const double share = y / width;
    const double sampled = Interpolate(values_[table], interval, share);
    for (int other = 0; other < 3; ++other) {
      sample.weight[other] =
          Interpolate(values_[static_cast<std::size_t>(other)], interval, share) / sampled;
    }
  }
  return sample;
}

}  // namespace thunderhead::reference
