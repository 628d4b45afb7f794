#include "app/phase_flag.h"

#include <array>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/strip.h"
#include "base/status.h"
#include "physics/optics.h"
#include "physics/phase_table.h"

namespace thunderhead::app {
namespace {

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

absl::StatusOr<SampledPhase> Parse(const std::string& text) {
  absl::string_view rest = text;
  if (absl::ConsumePrefix(&rest, "table:")) return FromTable(rest);
  physics::PhaseFunction phase;
  bool known = true;
  if (text == "rayleigh") {
    phase.kind = physics::PhaseKind::kRayleigh;
    return SampledPhase::Of(phase);
  }
  if (absl::ConsumePrefix(&rest, "hg:")) {
    phase.kind = physics::PhaseKind::kHenyeyGreenstein;
  } else if (absl::ConsumePrefix(&rest, "cs:")) {
    phase.kind = physics::PhaseKind::kCornetteShanks;
  } else {
    known = false;
  }
  if (!known || !absl::SimpleAtof(rest, &phase.asymmetry)) {
    return absl::InvalidArgumentError(absl::StrCat(
        "--phase is '", text, "'; it must be hg:G, cs:G, rayleigh or table:NAME, e.g. hg:0.85"));
  }
  if (!(phase.asymmetry >= -kMaxAsymmetry && phase.asymmetry <= kMaxAsymmetry)) {
    return absl::InvalidArgumentError(
        absl::StrCat("--phase is '", text, "'; its asymmetry must be from -0.99 to 0.99"));
  }
  return SampledPhase::Of(phase);
}

}  // namespace

absl::StatusOr<std::shared_ptr<const SampledPhase>> ParsePhase(const std::string& text) {
  THUNDERHEAD_ASSIGN_OR_RETURN(SampledPhase phase, Parse(text));
  return std::make_shared<const SampledPhase>(std::move(phase));
}

}  // namespace thunderhead::app
