#include "clouds/metaballs.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/whole_file.h"

namespace thunderhead::clouds {
namespace {

constexpr std::string_view kFirstLine = "thunderhead balls 1";

// Cut-off radius in units of the Gaussian's s. Beyond it, values are less than 1.3e-4 times the
// value at the centre.
constexpr double kGaussianReach = 3.0;

}  // namespace

std::string_view NameOf(Basis basis) { return basis == Basis::kGaussian ? "gaussian" : "wyvill"; }

double Reach_m(Basis basis, double overlap, double sigma_m) {
  return basis == Basis::kGaussian ? kGaussianReach * 0.5 * overlap * sigma_m : overlap * sigma_m;
}

double BasisValue(Basis basis, double overlap, double sigma_m, double distance_m) {
  if (distance_m >= Reach_m(basis, overlap, sigma_m)) return 0.0;
  if (basis == Basis::kGaussian) {
    const double ratio = distance_m / (0.5 * overlap * sigma_m);
    return std::exp(-ratio * ratio);
  }
  const double a = distance_m / (overlap * sigma_m);
  const double square = a * a;
  // In the scan of the paper, the signs of eq. 12 are wrong. These signs make the field fall from 1
  // to 0.
  return 1.0 + square * (-22.0 / 9.0 + square * (17.0 / 9.0 - square * (4.0 / 9.0)));
}

std::string ToText(const MetaballCloud& cloud) {
  std::string text = absl::StrFormat(
      "%s\nquantity %s %s\nbasis %s\noverlap %.17g\nlow_m %.17g %.17g %.17g\nhigh_m %.17g %.17g "
      "%.17g\nballs %d\n",
      std::string(kFirstLine), cloud.quantity, cloud.units, std::string(NameOf(cloud.basis)),
      cloud.overlap, cloud.low_m.x, cloud.low_m.y, cloud.low_m.z, cloud.high_m.x, cloud.high_m.y,
      cloud.high_m.z, cloud.balls.size());
  for (const Metaball& ball : cloud.balls) {
    absl::StrAppendFormat(&text, "ball %.17g %.17g %.17g %.17g %.17g\n", ball.centre_m.x,
                          ball.centre_m.y, ball.centre_m.z, ball.sigma_m, ball.weight);
  }
  return text;
}

absl::Status SaveBalls(const MetaballCloud& cloud, const std::string& path) {
  return base::WriteWholeFile(path, ToText(cloud));
}

}  // namespace thunderhead::clouds
