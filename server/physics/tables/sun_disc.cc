#include "physics/tables/sun_disc.h"

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "base/status.h"
#include "physics/atmosphere.h"

namespace thunderhead::physics {
namespace {

// Number of rings of equal area that divide the disc. They are narrower than the forward peak of
// rain.
constexpr int kRings = 64;
// Number of directions on one half of a ring. The other half is its mirror image.
constexpr int kDirections = 64;

// Tolerance for the table's mean over the sphere. The quadrature is inaccurate for light at angles
// below a hundredth of a degree.
constexpr double kMeanTolerance = 0.02;

struct DiscPoint {
  double along;  // cosine of the angle from the middle
  // Component perpendicular to the direction of the middle, towards smaller scattering angles.
  double across;
};

std::vector<DiscPoint> PointsOfDisc() {
  std::vector<DiscPoint> points;
  for (int i = 0; i < kRings; ++i) {
    const double from_middle_rad = kSunRadius_rad * std::sqrt((i + 0.5) / kRings);
    for (int j = 0; j < kDirections; ++j) {
      const double azimuth_rad = std::numbers::pi * (j + 0.5) / kDirections;
      points.push_back(
          {std::cos(from_middle_rad), std::sin(from_middle_rad) * std::cos(azimuth_rad)});
    }
  }
  return points;
}

}  // namespace

PhaseTable UnderSunDisc(const PhaseTable& point) {
  const std::vector<DiscPoint> disc = PointsOfDisc();
  PhaseTableContent content{.name = point.name(),
                            .wavelengths_um = point.wavelengths_um(),
                            .angles_deg = point.angles_deg(),
                            .values = {}};
  for (const double angle_deg : content.angles_deg) {
    const double angle_rad = angle_deg * std::numbers::pi / 180.0;
    PhaseRgb mean{};
    for (const DiscPoint& sun : disc) {
      const double mu = std::cos(angle_rad) * sun.along + std::sin(angle_rad) * sun.across;
      for (std::size_t c = 0; c < kPhaseChannels; ++c) {
        mean[c] += point.ValueAtCosine(mu, c) / static_cast<double>(disc.size());
      }
    }
    content.values.push_back(mean);
  }
  absl::StatusOr<PhaseTable> table = PhaseTable::Create(std::move(content), kMeanTolerance);
  THUNDERHEAD_CHECK(table.ok(), std::string(table.status().message()));
  return *std::move(table);
}

}  // namespace thunderhead::physics
