#include "clouds/metaballs.h"

#include <cmath>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "base/status.h"
#include "base/whole_file.h"
#include "glm/geometric.hpp"

namespace thunderhead::clouds {
namespace {

constexpr std::string_view kFirstLine = "thunderhead balls 1";

// Cut-off radius in units of the Gaussian's s; values beyond are less than 1.3e-4 of the centre's.
constexpr double kGaussianReach = 3.0;

constexpr std::size_t kMaxBalls = 10'000'000;

using Words = std::vector<std::string>;

absl::Status BadLine(std::size_t line, const std::string& wanted) {
  return absl::InvalidArgumentError(
      absl::StrCat("line ", line + 1, " is not as it must be: ", wanted));
}

// The numbers of `words` from the second on.
bool ParseNumbers(const Words& words, std::size_t count, double* numbers) {
  if (words.size() != count + 1) return false;
  for (std::size_t i = 0; i < count; ++i) {
    if (!absl::SimpleAtod(words[i + 1], &numbers[i]) || !std::isfinite(numbers[i])) return false;
  }
  return true;
}

absl::Status ParseHeader(const std::vector<Words>& lines, MetaballCloud* cloud,
                         std::size_t* count) {
  if (lines[1].size() != 3 || lines[1][0] != "quantity") return BadLine(1, "quantity NAME UNITS");
  cloud->quantity = lines[1][1];
  cloud->units = lines[1][2];
  if (lines[2] == Words{"basis", "gaussian"}) {
    cloud->basis = Basis::kGaussian;
  } else if (lines[2] == Words{"basis", "wyvill"}) {
    cloud->basis = Basis::kWyvill;
  } else {
    return BadLine(2, "basis gaussian or basis wyvill");
  }
  double numbers[3];
  if (lines[3].empty() || lines[3][0] != "overlap" || !ParseNumbers(lines[3], 1, numbers) ||
      !(numbers[0] > 0.0)) {
    return BadLine(3, "overlap U, above 0");
  }
  cloud->overlap = numbers[0];
  if (!ParseNumbers(lines[4], 3, numbers)) return BadLine(4, "low_m X Y Z");
  cloud->low_m = {numbers[0], numbers[1], numbers[2]};
  if (!ParseNumbers(lines[5], 3, numbers)) return BadLine(5, "high_m X Y Z");
  cloud->high_m = {numbers[0], numbers[1], numbers[2]};
  if (!ParseNumbers(lines[6], 1, numbers) || !(numbers[0] >= 1.0) || numbers[0] > kMaxBalls) {
    return BadLine(6, "balls N, from 1");
  }
  *count = static_cast<std::size_t>(numbers[0]);
  return absl::OkStatus();
}

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
  // The scan prints the signs of eq. 12 wrongly: the field must fall from 1 to 0.
  return 1.0 + square * (-22.0 / 9.0 + square * (17.0 / 9.0 - square * (4.0 / 9.0)));
}

double ValueAt(const MetaballCloud& cloud, const glm::dvec3& point_m) {
  double sum = 0.0;
  for (const Metaball& ball : cloud.balls) {
    const double distance_m = glm::length(point_m - ball.centre_m);
    sum += ball.weight * BasisValue(cloud.basis, cloud.overlap, ball.sigma_m, distance_m);
  }
  return sum;
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

absl::StatusOr<MetaballCloud> FromText(std::string_view text) {
  std::vector<Words> lines;
  for (const auto line :
       absl::StrSplit(absl::string_view(text.data(), text.size()), '\n', absl::SkipEmpty())) {
    lines.push_back(absl::StrSplit(line, ' ', absl::SkipEmpty()));
  }
  constexpr std::size_t kHeaderLines = 7;
  if (lines.empty() || lines[0] != Words{"thunderhead", "balls", "1"}) {
    return BadLine(0, std::string(kFirstLine));
  }
  if (lines.size() < kHeaderLines) return BadLine(lines.size(), "the header has 7 lines");
  MetaballCloud cloud;
  std::size_t count = 0;
  THUNDERHEAD_RETURN_IF_ERROR(ParseHeader(lines, &cloud, &count));
  if (lines.size() - kHeaderLines != count) {
    return absl::InvalidArgumentError(absl::StrCat("has ", lines.size() - kHeaderLines,
                                                   " balls where its header promises ", count,
                                                   "; it is cut short or damaged"));
  }
  for (std::size_t line = kHeaderLines; line < lines.size(); ++line) {
    double n[5];
    if (lines[line][0] != "ball" || !ParseNumbers(lines[line], 5, n) || !(n[3] > 0.0)) {
      return BadLine(line, "ball X Y Z SIGMA WEIGHT, sigma above 0");
    }
    cloud.balls.push_back({{n[0], n[1], n[2]}, n[3], n[4]});
  }
  return cloud;
}

absl::Status SaveBalls(const MetaballCloud& cloud, const std::string& path) {
  return base::WriteWholeFile(path, ToText(cloud));
}

absl::StatusOr<MetaballCloud> LoadBalls(const std::string& path) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::string text, base::ReadWholeFile(path));
  absl::StatusOr<MetaballCloud> cloud = FromText(text);
  if (!cloud.ok()) return base::Annotate(cloud.status(), path);
  return cloud;
}

}  // namespace thunderhead::clouds
