// The flag --phase.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "reference/sampled_phase.h"

namespace thunderhead::app {

// Returns the help of the flag, which lists its formats.
std::string PhaseFlagHelp();

// Parses a phase function: "table:NAME", or a formula by its name in physics::kPhaseKindNames or by
// a short name. A formula that uses the asymmetry has it after a colon. Examples are "hg:0.85",
// "henyey_greenstein:0.85", "rayleigh" and "table:cloud_re10". INVALID_ARGUMENT lists the formats.
absl::StatusOr<std::shared_ptr<const reference::SampledPhase>> ParsePhase(const std::string& text);

}  // namespace thunderhead::app
