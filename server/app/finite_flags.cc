#include "app/finite_flags.h"

#include <cmath>
#include <string>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"

namespace thunderhead::app {
namespace {

// Returns the error for a number that is not finite, otherwise an empty text. CLI11 itself refuses
// a text that is no number.
std::string Check(const std::string& text) {
  double value = 0.0;
  if (!absl::SimpleAtod(text, &value) || std::isfinite(value)) return "";
  return absl::StrCat("'", text, "' is not a finite number");
}

}  // namespace

void RefuseInfiniteNumbers(CLI::App& command) {
  for (CLI::Option* const option : command.get_options()) {
    if (absl::StrContains(option->get_type_name(), "FLOAT")) option->check(Check);
  }
  for (CLI::App* const subcommand : command.get_subcommands({})) RefuseInfiniteNumbers(*subcommand);
}

}  // namespace thunderhead::app
