#include "volume/projection_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "absl/strings/escaping.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "base/status.h"

namespace thunderhead::volume {
namespace {

constexpr std::size_t kMaxLength = 1000;

// Projections of PROJ whose coordinates are metres and that need no file.
constexpr std::array kProjections = {"aea", "aeqd", "cea",   "eqc",   "geos",   "laea",
                                     "lcc", "merc", "stere", "tmerc", "ob_tran"};
constexpr std::array kNumbers = {
    "R", "a",   "b",   "rf", "f",  "lat_0", "lat_1", "lat_2",   "lat_ts",  "lon_0",   "k_0",
    "k", "x_0", "y_0", "h",  "pm", "alpha", "gamma", "o_lat_p", "o_lon_p", "to_meter"};
constexpr std::array kFlags = {"no_defs"};
constexpr std::array kEllipsoids = {"GRS80", "WGS84",  "bessel", "clrk66",
                                    "intl",  "sphere", "krass",  "airy"};
constexpr std::array kDatums = {"WGS84", "NAD83"};

template <std::size_t count>
bool IsIn(const std::array<const char*, count>& list, std::string_view word) {
  return std::ranges::find(list, word) != list.end();
}

// Returns the end of an error message that names the accepted words.
template <std::size_t count>
std::string AcceptedOf(const std::array<const char*, count>& list) {
  std::string names;
  for (const char* const name : list) absl::StrAppend(&names, names.empty() ? "" : ", ", name);
  return absl::StrCat("; accepted are ", names);
}

bool IsNumber(const std::string& text) {
  double value = 0.0;
  return absl::SimpleAtod(text, &value) && std::isfinite(value);
}

// Returns what is wrong with a parameter, or an empty text.
std::string ProblemOf(const std::string& name, const std::string& value) {
  const auto need = [&](bool holds, const std::string& wanted) {
    return holds ? "" : absl::StrCat("+", name, "=", absl::CEscape(value), " is not ", wanted);
  };
  if (IsIn(kNumbers, name)) return need(IsNumber(value), "a number");
  if (IsIn(kFlags, name)) return need(value.empty(), "without a value");
  if (name == "proj") {
    return need(IsIn(kProjections, value),
                absl::StrCat("a projection that storms can have", AcceptedOf(kProjections)));
  }
  if (name == "o_proj") return need(value == "eqc", "eqc, the projection of a rotated grid");
  if (name == "ellps") {
    return need(IsIn(kEllipsoids, value), absl::StrCat("known", AcceptedOf(kEllipsoids)));
  }
  if (name == "datum")
    return need(IsIn(kDatums, value), absl::StrCat("known", AcceptedOf(kDatums)));
  if (name == "units") return need(value == "m", "m, the unit of a storm's coordinates");
  if (name == "sweep") return need(value == "x" || value == "y", "x or y");
  return absl::StrCat("+", absl::CEscape(name), " is not accepted from a storm file");
}

}  // namespace

absl::StatusOr<ProjectionText> ProjectionText::Parse(std::string_view text) {
  const auto refused = [&](const std::string& problem) {
    return absl::InvalidArgumentError(absl::StrCat(
        "the map projection '",
        absl::CEscape(absl::string_view(text.data(), std::min(text.size(), kMaxLength))),
        "' cannot be used: ", problem));
  };
  if (text.size() > kMaxLength) return refused("it is too long");
  ProjectionText parsed;
  for (const absl::string_view word :
       absl::StrSplit(absl::string_view(text.data(), text.size()), ' ', absl::SkipEmpty())) {
    const std::pair<std::string, std::string> parts =
        absl::StrSplit(absl::StripPrefix(word, "+"), absl::MaxSplits('=', 1));
    if (std::string problem = ProblemOf(parts.first, parts.second); !problem.empty()) {
      return refused(problem);
    }
    if (!parsed.parameters_.insert(parts).second) {
      return refused(absl::StrCat("+", parts.first, " is given twice"));
    }
  }
  if (!parsed.Has("proj")) return refused("it does not name a projection (+proj=)");
  const bool rotated = parsed.Text("proj") == "ob_tran";
  if (rotated != parsed.Has("o_proj")) {
    return refused("a rotated pole needs +proj=ob_tran and +o_proj=eqc together");
  }
  if (rotated && (!parsed.Has("o_lat_p") || !parsed.Has("R"))) {
    return refused("a rotated pole needs +o_lat_p= and, because it is on a sphere, +R=");
  }
  const auto has = [&](const char* name) { return parsed.Has(name); };
  if (!has("R") && !has("a") && !has("ellps") && !has("datum")) {
    return refused("it does not give the size of the Earth (+R=, +a= or +ellps=)");
  }
  // PROJ would silently ignore the second parameter.
  if (has("units") && has("to_meter")) return refused("it has both +units= and +to_meter=");
  parsed.kind_ = parsed.Text(rotated ? "o_proj" : "proj");
  return parsed;
}

bool ProjectionText::Has(std::string_view parameter) const {
  return parameters_.find(parameter) != parameters_.end();
}

std::string ProjectionText::Text(std::string_view parameter) const {
  const auto found = parameters_.find(parameter);
  return found == parameters_.end() ? "" : found->second;
}

std::optional<double> ProjectionText::Number(std::string_view parameter) const {
  double value = 0.0;
  if (!absl::SimpleAtod(Text(parameter), &value) || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace thunderhead::volume
