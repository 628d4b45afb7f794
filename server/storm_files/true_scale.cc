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

// Returns the logarithm of a Lambert projection's reciprocal scale at a latitude, up to a constant.
// `cone` is the projection's cone constant.
double LogScale(double latitude, double cone) {
  return std::log(std::cos(latitude)) +
         cone * std::log(std::tan(glm::quarter_pi<double>() + latitude / 2.0));
}

double ConeOf(double first, double second) {
  if (std::abs(first - second) < 1e-9) return std::sin(first);
  const auto stretched = [](double latitude) {
    return std::log(std::tan(glm::quarter_pi<double>() + latitude / 2.0));
  };
  return std::log(std::cos(first) / std::cos(second)) / (stretched(second) - stretched(first));
}

// Returns the other latitude at which a Lambert projection has the same scale as at `latitude`.
double Conjugate(double latitude, double cone) {
  // The scale is least at the latitude whose sine is the cone constant.
  const double middle = std::asin(std::clamp(cone, -1.0, 1.0));
  const double wanted = LogScale(latitude, cone);
  double near = middle;
  double far = latitude < middle ? kPole : -kPole;
  constexpr int kBisections = 100;
  for (int i = 0; i < kBisections; ++i) {
    const double half = 0.5 * (near + far);
    (LogScale(half, cone) > wanted ? near : far) = half;
  }
  return 0.5 * (near + far);
}

void SetParallels(const volume::EarthPlace& middle, ProjectionWords& words) {
  const double first_deg = words.Number("lat_1").value_or(0.0);
  const double second_deg = words.Number("lat_2").value_or(first_deg);
  const double latitude = std::clamp(glm::radians(middle.latitude_deg), -kPole, kPole);
  const double cone = ConeOf(glm::radians(first_deg), glm::radians(second_deg));
  const double other = Conjugate(latitude, cone);
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

std::string WithTrueScaleAt(const std::string& projection, const volume::EarthPlace& middle,
                            double middle_y_deg) {
  ProjectionWords words(projection);
  const bool rotated = words.Text("proj") == "ob_tran";
  const std::string kind = words.Text(rotated ? "o_proj" : "proj");
  const bool polar = std::abs(words.Number("lat_0").value_or(0.0)) == 90.0;
  if (!words.Has("R") || words.Has("k_0") || words.Has("k")) return projection;
  if (kind == "lcc" && words.Has("lat_1")) {
    SetParallels(middle, words);
  } else if (kind == "merc" || (kind == "stere" && polar)) {
    words.Set("lat_ts", middle.latitude_deg);
  } else if (kind == "eqc") {
    words.Set("lat_ts", middle_y_deg);
  } else {
    return projection;
  }
  return words.Joined();
}

}  // namespace thunderhead::storm_files
