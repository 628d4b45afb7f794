#include "app/phase_flag.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "base/status.h"
#include "physics/optics.h"
#include "physics/phase_table.h"

namespace thunderhead::app {
namespace {

using physics::PhaseKind;
using reference::SampledPhase;

// Largest asymmetry. Above it, the forward peak is narrower than the tables' angular steps.
constexpr float kMaxAsymmetry = 0.99F;

absl::StatusOr<SampledPhase> FromTable(absl::string_view name) {
  const auto table = physics::EmbeddedPhaseTable({name.data(), name.size()});
  if (!table.ok()) {
    return absl::InvalidArgumentError(
        absl::StrCat("--phase names the unknown table '", name, "'; the tables are ",
                     absl::StrJoin(physics::PhaseTableNames(), ", ")));
  }
  std::array<SampledPhase::Function, 3> by_color;
  for (std::size_t color = 0; color < by_color.size(); ++color) {
    by_color[color] = [&table, color](double mu) { return table->ValueAtCosine(mu, color); };
  }
  return SampledPhase::Tabulated(by_color);
}

// A short name of a formula for the flag. Other formulas have only their name in kPhaseKindNames.
struct ShortName {
  PhaseKind kind;
  std::string_view name;
};
constexpr std::array kShortNames = {
    ShortName{PhaseKind::kHenyeyGreenstein, "hg"},
    ShortName{PhaseKind::kCornetteShanks, "cs"},
};

// A formula of physics/optics.cc and its names.
struct NamedFormula {
  const physics::PhaseFormula* formula;
  std::string name;
  std::string short_name;  // the same as `name` if there is no short name
};

std::vector<NamedFormula> NamedFormulas() {
  std::vector<NamedFormula> named;
  for (const auto& [kind, name] : physics::kPhaseKindNames) {
    const physics::PhaseFormula* const formula = physics::FormulaOf(kind);
    if (formula == nullptr) continue;
    const auto* const known = std::ranges::find(kShortNames, kind, &ShortName::kind);
    named.push_back(
        {formula, std::string(name), std::string(known == kShortNames.end() ? name : known->name)});
  }
  return named;
}

// Returns the values that the flag may have, such as "hg:G, rayleigh or table:NAME".
std::string Formats() {
  std::vector<std::string> formulas;
  for (const NamedFormula& each : NamedFormulas()) {
    formulas.push_back(absl::StrCat(each.short_name, each.formula->has_asymmetry ? ":G" : ""));
  }
  return absl::StrCat(absl::StrJoin(formulas, ", "), " or table:NAME");
}

absl::Status WrongFormat(const std::string& text) {
  return absl::InvalidArgumentError(
      absl::StrCat("--phase is '", text, "'; it must be ", Formats(), ", e.g. hg:0.85"));
}

absl::StatusOr<SampledPhase> Parse(const std::string& text) {
  absl::string_view table = text;
  if (absl::ConsumePrefix(&table, "table:")) return FromTable(table);
  const std::pair<std::string, std::string> parts = absl::StrSplit(text, absl::MaxSplits(':', 1));
  const std::vector<NamedFormula> formulas = NamedFormulas();
  const auto found = std::ranges::find_if(formulas, [&parts](const NamedFormula& each) {
    return parts.first == each.name || parts.first == each.short_name;
  });
  if (found == formulas.end()) return WrongFormat(text);
  physics::PhaseFunction phase{found->formula->kind};
  if (!found->formula->has_asymmetry) {
    if (text != parts.first) return WrongFormat(text);
    return SampledPhase::Of(phase);
  }
  if (!absl::SimpleAtof(parts.second, &phase.asymmetry)) return WrongFormat(text);
  if (!(phase.asymmetry >= -kMaxAsymmetry && phase.asymmetry <= kMaxAsymmetry)) {
    return absl::InvalidArgumentError(
        absl::StrCat("--phase is '", text, "'; its asymmetry must be from -0.99 to 0.99"));
  }
  return SampledPhase::Of(phase);
}

}  // namespace

std::string PhaseFlagHelp() {
  return absl::StrCat("Phase function: ", Formats(),
                      "; hg is Henyey-Greenstein and cs Cornette-Shanks");
}

absl::StatusOr<std::shared_ptr<const SampledPhase>> ParsePhase(const std::string& text) {
  THUNDERHEAD_ASSIGN_OR_RETURN(SampledPhase phase, Parse(text));
  return std::make_shared<const SampledPhase>(std::move(phase));
}

}  // namespace thunderhead::app
