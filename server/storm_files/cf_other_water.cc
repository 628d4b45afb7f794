#include "storm_files/cf_other_water.h"

#include <algorithm>
#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "storm_files/units.h"

namespace thunderhead::storm_files {
namespace {

constexpr std::array<std::string_view, 17> kWater = {
    "water",     "cloud",      "clouds",      "liquid",       "ice",           "rain",
    "snow",      "graupel",    "hail",        "rainwater",    "precipitation", "drizzle",
    "condensed", "condensate", "hydrometeor", "hydrometeors", "precipitating"};
constexpr std::array<std::string_view, 11> kOther = {
    "vapor", "vapour", "humidity",   "aerosol",         "aerosols", "dust",
    "salt",  "nuclei", "saturation", "supersaturation", "saturated"};

// Returns the words of a name or sentence, in small letters.
std::vector<std::string> WordsIn(const std::string& text) {
  return absl::StrSplit(absl::AsciiStrToLower(text), absl::ByAnyChar(" _-,;:()[]/."),
                        absl::SkipEmpty());
}

bool HasAny(const std::vector<std::string>& words, std::span<const std::string_view> list) {
  return std::ranges::any_of(
      words, [&](const std::string& word) { return std::ranges::find(list, word) != list.end(); });
}

bool SaysWater(const std::string& text) {
  const std::vector<std::string> words = WordsIn(text);
  return HasAny(words, kWater) && !HasAny(words, kOther);
}

// Returns whether the unit is a mass per mass, such as g kg-1, or a mass per volume. A plain number
// may be a share of anything.
bool IsUnitOfMass(const std::string& units) {
  if (HasNoUnits(units)) return false;
  const bool ratio =
      ConversionOf(units, "1").has_value() && absl::StrContains(absl::AsciiStrToLower(units), "g");
  return ratio || ConversionOf(units, "kg m-3").has_value();
}

}  // namespace

bool IsStandardNameOfWater(const std::string& standard_name) {
  const bool amount =
      absl::StartsWith(standard_name, "mass_fraction_of_") ||
      absl::StartsWith(standard_name, "mass_concentration_of_") ||
      absl::StartsWith(standard_name, "mass_content_of_") ||
      absl::EndsWith(standard_name, "_mixing_ratio") ||
      (absl::StartsWith(standard_name, "specific_") && absl::EndsWith(standard_name, "_content"));
  return amount && SaysWater(standard_name);
}

std::optional<std::string> WhyWaterIsNotShown(const CfDescription& variable) {
  if (QuantityOf(variable).has_value() || AirVariableOf(variable).has_value()) return std::nullopt;
  CfDescription named = variable;
  named.standard_name.clear();
  const bool named_water = QuantityOf(named).has_value();
  if (IsStandardNameOfWater(variable.standard_name) ||
      (named_water && !variable.standard_name.empty())) {
    return absl::StrCat("its standard name ", variable.standard_name,
                        " is not that of a hydrometeor that is shown");
  }
  const bool says_water = SaysWater(variable.long_name) || SaysWater(variable.standard_name) ||
                          SaysWater(variable.name) ||
                          absl::StartsWithIgnoreCase(variable.name, "q");
  if (!says_water || !IsUnitOfMass(variable.units)) return std::nullopt;
  return "its name is not that of a hydrometeor that is shown; if it is one, give it a standard "
         "name";
}

}  // namespace thunderhead::storm_files
