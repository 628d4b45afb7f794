#include "storm_files/grib_summary.h"

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "physics/hydrometeors.h"
#include "storm_files/grib_parameters.h"

namespace thunderhead::storm_files {
namespace {

using Levels = std::set<std::pair<int, double>>;  // type and value of surfaces

struct NamedLevels {
  std::string name;
  Levels levels;
};

std::string NameOf(const grib::Field& field, const GribMeaning& meaning) {
  if (meaning.kind != GribKind::kAmount) return GribKindName(meaning.kind);
  return absl::StrCat(std::string(physics::NameOf(meaning.hydrometeor)), " (",
                      grib::NumbersOf(field.parameter), ")");
}

std::string Counted(const NamedLevels& found) {
  const std::size_t count = found.levels.size();
  return absl::StrCat(found.name, " on ", count, count == 1 ? " level" : " levels");
}

// Joins texts as in a sentence: "a, b and c".
std::string Listed(const std::vector<std::string>& texts) {
  if (texts.size() < 2) return absl::StrJoin(texts, "");
  return absl::StrCat(absl::StrJoin(texts.begin(), texts.end() - 1, ", "), " and ", texts.back());
}

}  // namespace

std::string SummaryOfGrib(const grib::Index& index) {
  std::vector<NamedLevels> found;
  // A storm needs each of these kinds on at least two levels.
  constexpr std::array kNeeded = {GribKind::kAmount, GribKind::kTemperature};
  std::array<Levels, kNeeded.size()> needed;
  for (const grib::Field& field : index.fields) {
    const GribMeaning meaning = MeaningOf(field.parameter);
    if (!field.is_instant || meaning.kind == GribKind::kNone || IsOfLand(meaning.kind)) continue;
    const std::pair<int, double> level(field.first.type, field.first.value);
    const std::string name = NameOf(field, meaning);
    auto at = std::ranges::find(found, name, &NamedLevels::name);
    if (at == found.end()) at = found.insert(found.end(), {name, {}});
    at->levels.insert(level);
    const auto kind = std::ranges::find(kNeeded, meaning.kind);
    if (kind != kNeeded.end())
      needed[static_cast<std::size_t>(kind - kNeeded.begin())].insert(level);
  }
  std::vector<std::string> has;
  has.reserve(found.size());
  for (const NamedLevels& each : found) has.push_back(Counted(each));
  std::vector<std::string> lacks;
  for (std::size_t i = 0; i < kNeeded.size(); ++i) {
    if (needed[i].size() < 2) lacks.push_back(GribKindName(kNeeded[i]));
  }
  const std::string with = has.empty() ? "no field of a storm" : Listed(has);
  if (lacks.empty()) return absl::StrCat("it has ", with);
  return absl::StrCat("it has ", with, ", and no ", absl::StrJoin(lacks, " and no "),
                      " on two levels");
}

}  // namespace thunderhead::storm_files
