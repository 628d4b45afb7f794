// A tabulated phase function: red, green and blue values on a grid of scattering angles, linear in
// the angle in between. Its mean over the sphere is 1, as that of the formulas in optics.h. Reads
// and writes the text of data/phase; knows no files.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace thunderhead::physics {

inline constexpr std::size_t kPhaseChannels = 3;  // red, green, blue

// One value each for red, green and blue.
using PhaseRgb = std::array<double, kPhaseChannels>;

// The content of a table before it is checked.
struct PhaseTableContent {
  std::string name;
  PhaseRgb wavelengths_um{};
  std::vector<double> angles_deg;  // from 0 to 180, ascending
  std::vector<PhaseRgb> values;    // one for each angle
};

class PhaseTable {
 public:
  static constexpr double kForwardAngleDeg = 5.0;

  // Checks `content` and scales its values so that their mean over the sphere is exactly 1. Refuses
  // values whose mean is further than `mean_tolerance` from 1.
  static absl::StatusOr<PhaseTable> Create(PhaseTableContent content, double mean_tolerance);

  // Reads the text that ToText writes. Errors name the line.
  static absl::StatusOr<PhaseTable> Load(std::string_view text);

  // The table as text that Load reads; each line of `provenance` becomes a comment at its top.
  std::string ToText(std::string_view provenance) const;

  const std::string& name() const { return content_.name; }
  const PhaseRgb& wavelengths_um() const { return content_.wavelengths_um; }
  const std::vector<double>& angles_deg() const { return content_.angles_deg; }
  const std::vector<PhaseRgb>& values() const { return content_.values; }

  // The value at a scattering angle, or at its cosine; clamped to 0 to pi.
  double Value(double angle_rad, std::size_t channel) const;
  double ValueAtCosine(double mu, std::size_t channel) const;

  // The share of light scattered by less than `angle_rad`: 0 at 0, 1 at pi.
  double CumulativeShare(double angle_rad, std::size_t channel) const;

  // The angle within which the share `u` (0 to 1) of the light is scattered: the inverse of
  // CumulativeShare, so that a uniform random `u` gives an angle drawn from the phase function.
  double SampleAngle(double u, std::size_t channel) const;

  // The mean cosine of the scattering angle.
  double Asymmetry(std::size_t channel) const { return asymmetry_[channel]; }

  // The share of light scattered within kForwardAngleDeg.
  double ForwardShare(std::size_t channel) const;

  // The share cut off if the function is held at its value at `angle_rad` for all smaller angles:
  // the `forward_share` of physics::DeltaScaling.
  double CutShare(double angle_rad, std::size_t channel) const;

 private:
  explicit PhaseTable(PhaseTableContent content);

  std::size_t IntervalOf(double angle_rad) const;
  // The share of light scattered from the start of `interval` to `angle_rad` in it.
  double ShareWithin(std::size_t interval, double angle_rad, std::size_t channel) const;

  PhaseTableContent content_;
  std::vector<double> angles_rad_;
  std::vector<PhaseRgb> cumulative_;  // share up to each angle
  PhaseRgb asymmetry_{};
};

// The names of the tables built into the program, e.g. "cloud_re10", in alphabetical order.
std::vector<std::string> PhaseTableNames();

// The table of that name built into the program.
absl::StatusOr<PhaseTable> EmbeddedPhaseTable(std::string_view name);

}  // namespace thunderhead::physics
