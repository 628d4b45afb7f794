// A tabulated phase function: red, green and blue values on a grid of scattering angles,
// interpolated linearly in the angle. Its mean over the sphere is 1, like that of the formulas in
// optics.h. This code reads and writes the text format of data/phase, but does not use files.
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
  std::vector<double> angles_deg;  // ascending angles from 0 to 180
  std::vector<PhaseRgb> values;    // one for each angle
};

class PhaseTable {
 public:
  static constexpr double kForwardAngleDeg = 5.0;

  // Checks `content` and scales its values so that their mean over the sphere is exactly 1. Returns
  // INVALID_ARGUMENT if angles or values are invalid, or if the mean before scaling differs from 1
  // by more than `mean_tolerance`.
  static absl::StatusOr<PhaseTable> Create(PhaseTableContent content, double mean_tolerance);

  // Reads text in the format of ToText. Returns INVALID_ARGUMENT if the text is invalid. The
  // message names the line if a single line is wrong.
  static absl::StatusOr<PhaseTable> Load(std::string_view text);

  // Returns the table as text that Load can read. Each line of `provenance` becomes a comment at
  // the top of the text.
  std::string ToText(std::string_view provenance) const;

  const std::string& name() const { return content_.name; }
  const PhaseRgb& wavelengths_um() const { return content_.wavelengths_um; }
  const std::vector<double>& angles_deg() const { return content_.angles_deg; }
  const std::vector<PhaseRgb>& values() const { return content_.values; }

  // Returns the value at a scattering angle, or at its cosine. The angle is clamped to 0 to pi.
  double Value(double angle_rad, std::size_t channel) const;
  double ValueAtCosine(double mu, std::size_t channel) const;

  // Returns the share of light scattered by less than `angle_rad`. It is 0 at 0 and 1 at pi.
  double CumulativeShare(double angle_rad, std::size_t channel) const;

  // Returns the angle within which the share `u` (0 to 1) of the light is scattered. It is the
  // inverse of CumulativeShare, so a uniform random `u` gives an angle drawn from the phase
  // function.
  double SampleAngle(double u, std::size_t channel) const;

  // Returns the mean cosine of the scattering angle.
  double Asymmetry(std::size_t channel) const { return asymmetry_[channel]; }

  // Returns the share of light scattered within kForwardAngleDeg.
  double ForwardShare(std::size_t channel) const;

  // Returns the share of light that is cut off if the function's value at `angle_rad` replaces its
  // values at all smaller angles. It is the `forward_share` of physics::DeltaScaling.
  double CutShare(double angle_rad, std::size_t channel) const;

 private:
  explicit PhaseTable(PhaseTableContent content);

  std::size_t IntervalOf(double angle_rad) const;
  // Returns the share of light scattered from the start of `interval` to `angle_rad` in it.
  double ShareWithin(std::size_t interval, double angle_rad, std::size_t channel) const;

  PhaseTableContent content_;
  std::vector<double> angles_rad_;
  std::vector<PhaseRgb> cumulative_;  // share of light scattered by less than each angle
  PhaseRgb asymmetry_{};
};

// Returns the names of the tables built into the program, e.g. "cloud_re10", in alphabetical order.
std::vector<std::string> PhaseTableNames();

// Returns the table of that name built into the program, or NOT_FOUND.
absl::StatusOr<PhaseTable> EmbeddedPhaseTable(std::string_view name);

}  // namespace thunderhead::physics
