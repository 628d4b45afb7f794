#include "app/value_checks.h"

#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "base/digits.h"

namespace thunderhead::app {
namespace {

// Each of these functions returns the error for a text, or an empty text if it is valid.

// Returns an error only for a number that is not finite. A text that is no number is left to CLI11,
// which refuses it.
std::string CheckDecimal(const std::string& text) {
  double value = 0.0;
  if (!absl::SimpleAtod(text, &value) || std::isfinite(value)) return "";
  return absl::StrCat("'", text, "' is not a finite number");
}

template <typename Number>
std::string CheckInteger(const std::string& text) {
  const std::string_view digits = std::string_view(text).substr(text.starts_with('-') ? 1 : 0);
  const bool is_padded = digits.size() > 1 && digits.front() == '0';
  if (is_padded || !base::IsDigits(digits)) {
    return absl::StrCat("'", text, "' is not an integer in decimal digits without leading zeros");
  }
  // A short text can fail here only because it is negative and Number is unsigned. Other checks
  // refuse negative numbers where none is possible.
  Number value = 0;
  if (absl::SimpleAtoi(text, &value) || digits.size() <= 18) return "";
  return absl::StrCat("'", text, "' is too large for an integer of 64 bits");
}

std::string CheckFlag(const std::string& text) {
  if (text == "true" || text == "false") return "";
  return absl::StrCat("'", text, "' is neither true nor false");
}

}  // namespace

void RefuseWrongValues(CLI::App& command) {
  for (CLI::Option* const option : command.get_options()) {
    const std::string type = option->get_type_name();
    if (option->get_expected_max() == 0) option->check(CheckFlag);
    if (absl::StrContains(type, "FLOAT")) option->check(CheckDecimal);
    if (absl::StartsWith(type, "INT")) option->check(CheckInteger<std::int64_t>);
    if (absl::StartsWith(type, "UINT")) option->check(CheckInteger<std::uint64_t>);
  }
  for (CLI::App* const subcommand : command.get_subcommands({})) RefuseWrongValues(*subcommand);
}

}  // namespace thunderhead::app
