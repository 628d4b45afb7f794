#include "storm_files/units.h"

#include <udunits2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <mutex>
#include <string>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"

namespace thunderhead::storm_files {
namespace {

// No unit's text is longer. A longer text is not parsed, because UDUNITS parses recursively.
constexpr std::size_t kLongestUnits = 100;

// UDUNITS is not safe from several threads.
std::mutex& UnitMutex() {
  static std::mutex mutex;
  return mutex;
}

// Returns the units of UDUNITS' database, or null. The caller must hold UnitMutex().
ut_system* UnitSystem() {
  static ut_system* const system = [] {
    ut_set_error_message_handler(ut_ignore);
    return ut_read_xml(nullptr);
  }();
  return system;
}

using OwnedUnit = std::unique_ptr<ut_unit, void (*)(ut_unit*)>;
using OwnedConverter = std::unique_ptr<cv_converter, void (*)(cv_converter*)>;

OwnedUnit ParseUnit(const std::string& text) {
  return {ut_parse(UnitSystem(), text.c_str(), UT_ASCII), ut_free};
}

// Returns whether the unit is an angle or contains one. UDUNITS converts angles to numbers.
bool IsAngularUnit(const ut_unit* unit) {
  std::array<char, 200> text{};
  const int length =
      ut_format(unit, text.data(), text.size() - 1, UT_ASCII | UT_DEFINITION | UT_NAMES);
  return length < 0 || absl::StrContains(text.data(), "radian");
}

struct UnitSpelling {
  std::string_view written;
  std::string_view meant;
};

// Spellings of models that UDUNITS does not know or takes for another unit: "mb" is its millibarn.
constexpr std::array kUnitSpellings = {
    UnitSpelling{"mb", "hPa"},
    UnitSpelling{"hpa", "hPa"},
    UnitSpelling{"HPA", "hPa"},
    UnitSpelling{"pa", "Pa"},
    UnitSpelling{"PA", "Pa"},
    UnitSpelling{"KG/KG", "kg/kg"},
    UnitSpelling{"KG KG-1", "kg/kg"},
    UnitSpelling{"KG/M3", "kg/m3"},
    UnitSpelling{"KG M-3", "kg/m3"},
    UnitSpelling{"G/KG", "g/kg"},
    UnitSpelling{"G KG-1", "g/kg"},
    UnitSpelling{"gpm", "m"},
    UnitSpelling{"KM", "km"},
    UnitSpelling{"M", "m"},
    UnitSpelling{"M/S", "m/s"},
    UnitSpelling{"M S-1", "m/s"},
    UnitSpelling{"k", "K"},
    UnitSpelling{"deg K", "K"},
    UnitSpelling{"deg C", "Celsius"},
    UnitSpelling{"C", "Celsius"},
    UnitSpelling{"degrees C", "Celsius"},
    UnitSpelling{"hr", "hour"},
    UnitSpelling{"hrs", "hour"},
    UnitSpelling{"mins", "minute"},
    UnitSpelling{"/m", "m-1"},
    UnitSpelling{"/kg", "kg-1"},
    UnitSpelling{"fraction", "1"},
    UnitSpelling{"dimensionless", "1"},
    UnitSpelling{"j/kg", "J/kg"},
    UnitSpelling{"m+2 s-2", "m2 s-2"},
    UnitSpelling{"kg kg^-1", "kg/kg"},
    UnitSpelling{"Kg/Kg", "kg/kg"},
    UnitSpelling{"Kg/kg", "kg/kg"},
    UnitSpelling{"kg/Kg", "kg/kg"},
    UnitSpelling{"Kg Kg-1", "kg/kg"},
    UnitSpelling{"g/Kg", "g/kg"},
    UnitSpelling{"g Kg-1", "g/kg"},
    UnitSpelling{"Kg/m3", "kg/m3"},
    UnitSpelling{"Kg m-3", "kg/m3"},
    UnitSpelling{"Km", "km"},
    UnitSpelling{"gpkm", "km"},
    UnitSpelling{"-", "1"},
    UnitSpelling{"degrees Celsius", "Celsius"},
    UnitSpelling{"degree Celsius", "Celsius"},
    UnitSpelling{"deg Celsius", "Celsius"},
    UnitSpelling{"degrees Kelvin", "K"},
    UnitSpelling{"degree Kelvin", "K"},
    UnitSpelling{"degrees K", "K"},
    UnitSpelling{"degrees north", "degrees_north"},
    UnitSpelling{"degree north", "degrees_north"},
    UnitSpelling{"degrees east", "degrees_east"},
    UnitSpelling{"degree east", "degrees_east"},
};

// Returns whether a text has a grain as a unit. Models that write "gr" mean a gram, which is 15
// times as much, so neither is assumed.
bool HasGrain(std::string_view text) {
  constexpr std::array<absl::string_view, 3> kGrains = {"gr", "grain", "grains"};
  const auto is_letter = [](char c) { return absl::ascii_isalpha(static_cast<unsigned char>(c)); };
  for (auto at = text.begin(); at != text.end();) {
    const auto first = std::find_if(at, text.end(), is_letter);
    at = std::find_if_not(first, text.end(), is_letter);
    const std::string word = absl::AsciiStrToLower(std::string(first, at));
    if (std::ranges::find(kGrains, word) != kGrains.end()) return true;
  }
  return false;
}

// Returns the unit of a text, or null. Exponents may be in brackets, as in "g.m^(-3)" and in MPAS's
// "kg m^{-3}".
OwnedUnit ParseUnitSpelling(std::string_view units) {
  std::string text(absl::StripAsciiWhitespace(absl::string_view(units.data(), units.size())));
  if (text.empty() || text.size() > kLongestUnits) return {nullptr, ut_free};
  std::erase_if(text, [](char c) { return c == '{' || c == '}'; });
  if (HasGrain(text)) return {nullptr, ut_free};
  const auto known =
      std::ranges::find(kUnitSpellings, std::string_view(text), &UnitSpelling::written);
  if (known != kUnitSpellings.end()) return ParseUnit(std::string(known->meant));
  if (OwnedUnit unit = ParseUnit(text); unit != nullptr) return unit;
  std::erase_if(text, [](char c) { return c == '(' || c == ')'; });
  return ParseUnit(text);
}

}  // namespace

absl::Status LoadUnits() {
  const std::lock_guard lock(UnitMutex());
  if (UnitSystem() != nullptr) return absl::OkStatus();
  return absl::FailedPreconditionError(
      "the database of units cannot be read; install the package libudunits2-data");
}

std::optional<UnitConversion> ConversionOf(std::string_view from, std::string_view to) {
  const std::lock_guard lock(UnitMutex());
  if (UnitSystem() == nullptr) return std::nullopt;
  const OwnedUnit given = ParseUnitSpelling(from);
  const OwnedUnit wanted = ParseUnit(std::string(to));
  if (given == nullptr || wanted == nullptr) return std::nullopt;
  if (IsAngularUnit(given.get()) != IsAngularUnit(wanted.get())) return std::nullopt;
  const OwnedConverter converter(ut_get_converter(given.get(), wanted.get()), cv_free);
  if (converter == nullptr) return std::nullopt;
  const double offset = cv_convert_double(converter.get(), 0.0);
  const double scale = cv_convert_double(converter.get(), 1.0) - offset;
  // Values times such a factor would be lost: a float holds neither the products nor their
  // inverses.
  constexpr double kLargestScale = 1e30;
  const double size = std::abs(scale);
  if (!(size >= 1.0 / kLargestScale && size <= kLargestScale) || !std::isfinite(offset)) {
    return std::nullopt;
  }
  // A unit in the denominator ("s" for "Hz") gives a converter that is not linear.
  const double two = cv_convert_double(converter.get(), 2.0);
  if (!(std::abs(two - offset - 2.0 * scale) <= 1e-9 * std::abs(scale))) return std::nullopt;
  return UnitConversion{scale, offset};
}

}  // namespace thunderhead::storm_files
