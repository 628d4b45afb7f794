#include "storm_files/true_scale.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "glm/gtc/constants.hpp"
#include "glm/trigonometric.hpp"

namespace thunderhead::storm_files {
namespace {

// The latitude in radians beyond which a Lambert projection has no scale.
constexpr double kPole = glm::half_pi<double>() - 1e-6;

// Returns the eccentricity of the Earth in a projection's text, or 0 for a sphere.
double EccentricityOf(const std::string& projection) {
  const absl::StatusOr<volume::MapProjection> map = volume::MapProjection::Open(projection);
  const double inverse = map.ok() ? map->Figure().inverse_flattening : 0.0;
  return inverse > 0.0 ? std::sqrt((2.0 - 1.0 / inverse) / inverse) : 0.0;
}

// The scale of a Lambert projection, by latitudes in radians.
class LambertScale {
 public:
  LambertScale(double first, double second, double eccentricity) : eccentricity_(eccentricity) {
    const bool is_tangent = std::abs(first - second) < 1e-9;
    cone_ = is_tangent ? std::sin(first)
                       : (LogParallel(first) - LogParallel(second)) /
                             (LogStretched(second) - LogStretched(first));
  }

  // Returns the other latitude with the same scale as at `latitude`.
  double Conjugate(double latitude) const {
    // The scale is least at the latitude whose sine is the cone constant.
    double near = std::asin(std::clamp(cone_, -1.0, 1.0));
    double far = latitude < near ? kPole : -kPole;
    const double wanted = LogReciprocal(latitude);
    constexpr int kBisections = 100;
    for (int i = 0; i < kBisections; ++i) {
      const double half = 0.5 * (near + far);
      (LogReciprocal(half) > wanted ? near : far) = half;
    }
    return 0.5 * (near + far);
  }

 private:
  // Returns the logarithm of a parallel's radius in the Earth's radii (Snyder 1987, Map
  // Projections, equation 14-15).
  double LogParallel(double latitude) const {
    const double sine = eccentricity_ * std::sin(latitude);
    return std::log(std::cos(latitude)) - 0.5 * std::log(1.0 - sine * sine);
  }
  // Returns the logarithm of the reciprocal of Snyder's t (equation 15-9).
  double LogStretched(double latitude) const {
    return std::log(std::tan(glm::quarter_pi<double>() + latitude / 2.0)) -
           eccentricity_ * std::atanh(eccentricity_ * std::sin(latitude));
  }
  // Returns the logarithm of the projection's reciprocal scale, up to a constant.
  double LogReciprocal(double latitude) const {
    return LogParallel(latitude) + cone_ * LogStretched(latitude);
  }

  double eccentricity_;
  double cone_ = 0.0;
};

void SetParallels(const volume::EarthPlace& middle, double eccentricity, ProjectionWords& words) {
  const double first_deg = words.Number("lat_1").value_or(0.0);
  const double second_deg = words.Number("lat_2").value_or(first_deg);
  const double latitude = std::clamp(glm::radians(middle.latitude_deg), -kPole, kPole);
  const LambertScale scale(glm::radians(first_deg), glm::radians(second_deg), eccentricity);
  const double other = scale.Conjugate(latitude);
  words.Set("lat_1", glm::degrees(std::min(latitude, other)));
  words.Set("lat_2", glm::degrees(std::max(latitude, other)));
}

}  // namespace

ProjectionWords::ProjectionWords(std::string_view text) {
  for (const absl::string_view word :
       absl::StrSplit(absl::string_view(text.data(), text.size()), ' ', absl::SkipEmpty())) {
    words_.push_back(absl::StrSplit(absl::StripPrefix(word, "+"), absl::MaxSplits('=', 1)));
  }
}

std::string ProjectionWords::Text(std::string_view name) const {
  const auto found = std::ranges::find(words_, name, &std::pair<std::string, std::string>::first);
  return found == words_.end() ? "" : found->second;
}

std::optional<double> ProjectionWords::Number(std::string_view name) const {
  double value = 0.0;
  if (!absl::SimpleAtod(Text(name), &value) || !std::isfinite(value)) return std::nullopt;
  return value;
}

bool ProjectionWords::Has(std::string_view name) const {
  return std::ranges::find(words_, name, &std::pair<std::string, std::string>::first) !=
         words_.end();
}

void ProjectionWords::Set(std::string_view name, const std::string& value) {
  const auto found = std::ranges::find(words_, name, &std::pair<std::string, std::string>::first);
  if (found != words_.end()) {
    found->second = value;
  } else {
    // The first word is the kind of the projection, and the last words are often flags.
    words_.insert(words_.begin() + std::min<std::ptrdiff_t>(1, std::ssize(words_)),
                  {std::string(name), value});
  }
}

void ProjectionWords::Set(std::string_view name, double value) {
  Set(name, absl::StrFormat("%.12g", value));
}

void ProjectionWords::Remove(std::string_view name) {
  std::erase_if(words_, [&](const auto& word) { return word.first == name; });
}

std::string ProjectionWords::Joined() const {
  std::string text;
  for (const auto& [name, value] : words_) {
    absl::StrAppend(&text, text.empty() ? "+" : " +", name, value.empty() ? "" : "=", value);
  }
  return text;
}

std::string EarthOf(std::string_view projection) {
  const ProjectionWords words(projection);
  std::string earth;
  for (const char* const name : {"R", "a", "b", "rf", "f", "ellps", "datum"}) {
    if (!words.Has(name)) continue;
    absl::StrAppend(&earth, earth.empty() ? "+" : " +", name, "=", words.Text(name));
  }
  return earth;
}

bool IsInDegrees(const ProjectionWords& words) {
  constexpr std::array kDegrees = {"longlat", "latlong", "lonlat", "latlon"};
  const std::string kind = words.Text(words.Text("proj") == "ob_tran" ? "o_proj" : "proj");
  return std::ranges::find(kDegrees, kind) != kDegrees.end();
}

bool IsConformal(const ProjectionWords& words) {
  constexpr std::array kConformal = {"lcc", "merc", "stere", "tmerc"};
  return std::ranges::find(kConformal, words.Text("proj")) != kConformal.end();
}

std::string WithTrueScaleAt(const std::string& projection, const volume::EarthPlace& middle,
                            double middle_y_deg) {
  ProjectionWords words(projection);
  const bool rotated = words.Text("proj") == "ob_tran";
  const std::string kind = words.Text(rotated ? "o_proj" : "proj");
  const double pole_deg = words.Number("lat_0").value_or(0.0);
  // PROJ takes a latitude of true scale as one of the pole's own hemisphere.
  const bool polar = std::abs(pole_deg) == 90.0 && pole_deg * middle.latitude_deg >= 0.0;
  if (kind == "lcc" && words.Has("lat_1")) {
    SetParallels(middle, EccentricityOf(projection), words);
  } else if (kind == "merc" || (kind == "stere" && polar)) {
    words.Set("lat_ts", middle.latitude_deg);
  } else if (kind == "eqc" && words.Has("R")) {
    words.Set("lat_ts", middle_y_deg);
    return words.Joined();
  } else {
    return projection;
  }
  for (const char* const scale : {"k", "k_0"}) words.Remove(scale);
  return words.Joined();
}

}  // namespace thunderhead::storm_files
