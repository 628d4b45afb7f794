#include "physics/phase_table.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "base/status.h"
#include "physics/embedded_phase_tables.h"
#include "physics/phase_integrals.h"

namespace thunderhead::physics {
namespace {

constexpr double kTableRadiansPerDegree = std::numbers::pi / 180.0;

absl::Status CheckShape(const PhaseTableContent& content) {
  const std::vector<double>& angles = content.angles_deg;
  if (angles.size() < 2 || angles.size() != content.values.size()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%d angles and %d values; give two or more of each, in equal numbers",
                        angles.size(), content.values.size()));
  }
  if (angles.front() != 0.0 || angles.back() != 180.0) {
    return absl::InvalidArgumentError(
        absl::StrFormat("the angles go from %g to %g degrees; they must go from 0 to 180",
                        angles.front(), angles.back()));
  }
  for (std::size_t i = 0; i < angles.size(); ++i) {
    // The negated comparison also rejects NaN.
    if (i > 0 && !(angles[i] > angles[i - 1])) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "angle %g degrees follows %g; angles must ascend", angles[i], angles[i - 1]));
    }
    for (const double value : content.values[i]) {
      if (!std::isfinite(value) || value < 0.0) {
        return absl::InvalidArgumentError(absl::StrFormat(
            "the value %g at %g degrees is not a finite number of 0 or more", value, angles[i]));
      }
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<PhaseTable> PhaseTable::Create(PhaseTableContent content, double mean_tolerance) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckShape(content));
  PhaseTable unscaled(content);
  const PhaseRgb& mean = unscaled.cumulative_.back();
  for (std::size_t c = 0; c < kPhaseChannels; ++c) {
    if (!(std::abs(mean[c] - 1.0) <= mean_tolerance)) {
      return absl::InvalidArgumentError(
          absl::StrFormat("the mean over the sphere is %g in channel %d; it must be 1 within %g",
                          mean[c], c, mean_tolerance));
    }
  }
  for (PhaseRgb& value : content.values) {
    for (std::size_t c = 0; c < kPhaseChannels; ++c) value[c] /= mean[c];
  }
  return PhaseTable(std::move(content));
}

PhaseTable::PhaseTable(PhaseTableContent content) : content_(std::move(content)) {
  const std::size_t count = content_.angles_deg.size();
  angles_rad_.reserve(count);
  for (const double angle_deg : content_.angles_deg) {
    angles_rad_.push_back(angle_deg * kTableRadiansPerDegree);
  }
  cumulative_.resize(count);
  for (std::size_t i = 0; i + 1 < count; ++i) {
    for (std::size_t c = 0; c < kPhaseChannels; ++c) {
      const LinearPiece piece{angles_rad_[i], angles_rad_[i + 1], content_.values[i][c],
                              content_.values[i + 1][c]};
      cumulative_[i + 1][c] = cumulative_[i][c] + ShareOf(piece);
      asymmetry_[c] += CosineOf(piece);
    }
  }
}

std::size_t PhaseTable::IntervalOf(double angle_rad) const {
  const auto next = std::upper_bound(angles_rad_.begin() + 1, angles_rad_.end() - 1, angle_rad);
  return static_cast<std::size_t>(next - angles_rad_.begin()) - 1;
}

double PhaseTable::Value(double angle_rad, std::size_t channel) const {
  const double angle = std::clamp(angle_rad, 0.0, angles_rad_.back());
  const std::size_t i = IntervalOf(angle);
  const double t = (angle - angles_rad_[i]) / (angles_rad_[i + 1] - angles_rad_[i]);
  return std::lerp(content_.values[i][channel], content_.values[i + 1][channel], t);
}

double PhaseTable::ValueAtCosine(double mu, std::size_t channel) const {
  return Value(std::acos(std::clamp(mu, -1.0, 1.0)), channel);
}

double PhaseTable::ShareWithin(std::size_t interval, double angle_rad, std::size_t channel) const {
  return ShareOf({angles_rad_[interval], angle_rad, content_.values[interval][channel],
                  Value(angle_rad, channel)});
}

double PhaseTable::CumulativeShare(double angle_rad, std::size_t channel) const {
  const double angle = std::clamp(angle_rad, 0.0, angles_rad_.back());
  const std::size_t i = IntervalOf(angle);
  return std::min(cumulative_[i][channel] + ShareWithin(i, angle, channel), 1.0);
}

double PhaseTable::SampleAngle(double u, std::size_t channel) const {
  const double wanted = std::clamp(u, 0.0, 1.0);
  const auto next = std::upper_bound(
      cumulative_.begin() + 1, cumulative_.end() - 1, wanted,
      [channel](double share, const PhaseRgb& cumulative) { return share < cumulative[channel]; });
  const std::size_t i = static_cast<std::size_t>(next - cumulative_.begin()) - 1;
  const double missing = wanted - cumulative_[i][channel];
  double low = angles_rad_[i];
  double high = angles_rad_[i + 1];
  double angle = 0.5 * (low + high);
  // If a Newton step would leave the bracket, the bracket is bisected instead. This happens because
  // the share is flat at angle 0.
  for (int step = 0; step < 60; ++step) {
    const double excess = ShareWithin(i, angle, channel) - missing;
    (excess > 0.0 ? high : low) = angle;
    const double slope = 0.5 * Value(angle, channel) * std::sin(angle);
    const double newton = slope > 0.0 ? angle - excess / slope : low;
    const double previous = angle;
    angle = newton > low && newton < high ? newton : 0.5 * (low + high);
    if (std::abs(angle - previous) < 1e-13) break;
  }
  return angle;
}

double PhaseTable::ForwardShare(std::size_t channel) const {
  return CumulativeShare(kForwardAngleDeg * kTableRadiansPerDegree, channel);
}

double PhaseTable::CutShare(double angle_rad, std::size_t channel) const {
  const double half_sine = std::sin(0.5 * angle_rad);
  const double kept = Value(angle_rad, channel) * half_sine * half_sine;
  return std::max(CumulativeShare(angle_rad, channel) - kept, 0.0);
}

std::vector<std::string> PhaseTableNames() {
  std::vector<std::string> names;
  for (const auto& [name, text] : EmbeddedPhaseTableTexts()) names.emplace_back(name);
  return names;
}

absl::StatusOr<PhaseTable> EmbeddedPhaseTable(std::string_view name) {
  const std::string wanted(name);
  const auto found = EmbeddedPhaseTableTexts().find(name);
  if (found == EmbeddedPhaseTableTexts().end()) {
    return absl::NotFoundError(absl::StrCat(
        "no phase table '", wanted, "'; there are: ", absl::StrJoin(PhaseTableNames(), ", ")));
  }
  absl::StatusOr<PhaseTable> table = PhaseTable::Load(found->second);
  if (!table.ok()) return base::Annotate(table.status(), "phase table " + wanted);
  return table;
}

}  // namespace thunderhead::physics
